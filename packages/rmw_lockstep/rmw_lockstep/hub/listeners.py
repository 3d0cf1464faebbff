"""How processes get their connections to the hub: by a socket with a path, or by one that they inherit."""

from __future__ import annotations

import array
import contextlib
import os
import socket
from pathlib import Path

from rmw_lockstep.hub.link import peer

#: The path of a Unix socket may not be longer (sun_path of unix(7), without its NUL).
LONGEST_PATH = 107


class Listener:
    """A listening socket with a path."""

    def __init__(self, path: Path, backlog: int) -> None:
        """Listen, for every user who may enter the folder.

        Raises ValueError if the path is too long for a socket, and OSError if no socket can be made.
        """
        if len(str(path).encode()) > LONGEST_PATH:
            raise ValueError(f"{path} is too long for a socket: at most {LONGEST_PATH} bytes")
        self._path = path
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self.socket.setblocking(False)
        self.socket.bind(str(path))
        path.chmod(0o666)
        path.parent.chmod(0o711)
        self.socket.listen(backlog)

    def accept(self) -> tuple[socket.socket, int]:
        """Return the next connection, and the id of its process. Raises BlockingIOError if there is none."""
        connection, _ = self.socket.accept()
        return connection, peer(connection)

    def close(self) -> None:
        """Stop listening."""
        self.socket.close()
        with contextlib.suppress(FileNotFoundError):
            self._path.unlink()


class InheritedSocket:
    """A pair of sockets: a program's processes inherit one end, and ask through it for a connection each.

    A process makes a pair of its own, and sends one end; the hub answers by that with an end of a third pair. So nobody
    else has the hub's end of the connection, and can change how it reads.
    """

    def __init__(self) -> None:
        self.socket, self._theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self.socket.setblocking(False)
        self.inherited = self._theirs.fileno()
        """The descriptor that the program inherits."""

    def accept(self) -> tuple[socket.socket, int]:
        """Return a connection for the next process that asks, and its id. Raises BlockingIOError if none asks.

        Raises OSError if somebody sent anything but a Unix socket.
        """
        _, descriptors, _, _ = socket.recv_fds(self.socket, 16, 1)
        if not descriptors:
            raise OSError("a request without a socket")
        with _unix_socket(descriptors[0]) as asking:
            pid = peer(asking)
            ours, theirs = socket.socketpair()
            with theirs, contextlib.suppress(OSError):  # it has ended meanwhile
                passed = [(socket.SOL_SOCKET, socket.SCM_RIGHTS, array.array("i", [theirs.fileno()]))]
                asking.sendmsg([b"+"], passed, socket.MSG_DONTWAIT | socket.MSG_NOSIGNAL)
        return ours, pid

    def close(self) -> None:
        """Give no more connections."""
        self.socket.close()
        self._theirs.close()


def _unix_socket(descriptor: int) -> socket.socket:
    try:
        found = socket.socket(fileno=descriptor)
    except OSError:
        os.close(descriptor)
        raise
    if found.family is not socket.AF_UNIX:
        found.close()
        raise OSError("not a Unix socket")
    return found
