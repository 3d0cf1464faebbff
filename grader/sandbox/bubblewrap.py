"""Makes a student's namespaces with bubblewrap, which holds them open until the student's process has entered them.

The program that bubblewrap itself runs is `cat`. It answers when everything is mounted. When this end of its pipe is
closed, for any reason, it ends, and everything else in the namespaces with it.
"""

from __future__ import annotations

import contextlib
import json
import os
import resource
import shutil
import signal
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path

from grader.sandbox import filesystem, seccomp, syscalls
from grader.sandbox.filesystem import Mount
from grader.sandbox.namespaces import Builder, Namespaces

_HOLDER_BYTES = 64 * 1024 * 1024

#: The descriptors from which bubblewrap reads the texts, in the order of `filesystem.TEXTS`: above those of its own.
_FIRST_TEXT = 100


def find() -> str | None:
    """Return the path of bubblewrap, if it is installed."""
    return shutil.which("bwrap")


def options(plan: Sequence[Mount]) -> bytes:
    """Return the options that build a root, as bubblewrap reads them from a file."""
    return b"".join(map(_encoded, plan))


def build(root: bytes, user_namespace: int) -> Namespaces:
    """Make the namespaces and their root, and move this process into them (except the pid namespace's children).

    There is no network, not even loopback. `root` has the `options` that build it, and `user_namespace` is that
    of the student. Raises OSError if bubblewrap could not be run or ended early; the text has its output.
    """
    program = find()
    if program is None:
        raise OSError("bubblewrap (bwrap) is not installed")
    texts = {
        _FIRST_TEXT + at: filesystem.memory_file(text.encode()) for at, text in enumerate(filesystem.TEXTS.values())
    }
    filters = [filesystem.memory_file(seccomp.program())] if seccomp.supported() else []
    # Not on the command line: the student can read it, and it would show the hidden paths.
    arguments = filesystem.memory_file(root)
    information, information_end = os.pipe()
    command = [
        *(program, "--userns", str(user_namespace), "--unshare-pid", "--unshare-ipc", "--unshare-uts"),
        *("--hostname", "student", "--cap-drop", "ALL", "--die-with-parent", "--info-fd", str(information_end)),
        *(option for number in filters for option in ("--seccomp", str(number))),
        *("--args", str(arguments), "--", "cat"),
    ]
    for number in (user_namespace, information_end, arguments, *filters):
        os.set_inheritable(number, True)
    builder = _start(command, texts)
    os.close(information_end)
    with contextlib.suppress(BrokenPipeError):
        os.write(builder.input, b"!")
    if os.read(builder.output, 1) != b"!":
        with os.fdopen(os.dup(builder.errors), "rb") as stream:
            errors = stream.read().decode(errors="replace").strip()
        raise OSError(f"bubblewrap ended with {builder.wait()}: {errors}")
    with os.fdopen(information) as text:
        init = int(json.load(text)["child-pid"])
    own_processes = frozenset(map(int, Path(f"/proc/{init}/task/{init}/children").read_text().split()))
    for holder in (init, *own_processes):
        _starve(holder)
    _join(init, user_namespace)
    syscalls.unshare(syscalls.CLONE_NEWNET)  # here and not by bubblewrap, which would enable loopback
    return Namespaces(init, own_processes, builder)


def _start(command: list[str], passed: Mapping[int, int]) -> Builder:
    """Run bubblewrap with pipes to it, the inheritable descriptors, and `passed`: its descriptors to ours.

    Use posix_spawn, which does not copy this process's memory as fork does. Python's own descriptors are not
    inheritable.
    """
    input_at, input_to = os.pipe()
    output_at, output_to = os.pipe()
    errors_at, errors_to = os.pipe()
    ends = (input_at, output_to, errors_to)
    pid = os.posix_spawn(
        command[0],
        command,
        {"PATH": "/usr/bin:/bin"},
        file_actions=[(os.POSIX_SPAWN_DUP2, ours, number) for number, ours in (*enumerate(ends), *passed.items())],
        setsigdef=(signal.SIGPIPE, signal.SIGXFSZ),  # Python ignores them
    )
    for end in ends:
        os.close(end)
    return Builder(pid, input_to, output_at, errors_at)


@lru_cache(maxsize=1024)
def _encoded(step: Mount) -> bytes:
    return b"".join(os.fsencode(option) + b"\0" for option in _options(step))


def _options(step: Mount) -> tuple[str, ...]:
    if step.action == "folder":
        return ("--perms", "0755", "--dir", step.path)
    if step.action == "scratch":
        return ("--perms", "1777", "--size", str(step.size), "--tmpfs", step.path)
    if step.action == "bind":
        return ("--ro-bind", step.content or step.path, step.path)
    if step.action == "mask":
        return ("--ro-bind", "/dev/null", step.path) if Path(step.path).is_file() else ("--tmpfs", step.path)
    if step.action == "device":
        return ("--dev-bind", step.path, step.path)
    if step.action == "link":
        return ("--symlink", step.content, step.path)
    if step.action == "text":
        return ("--perms", "0644", "--file", str(_FIRST_TEXT + list(filesystem.TEXTS).index(step.path)), step.path)
    return ("--proc" if step.action == "processes" else "--remount-ro", step.path)


def _starve(holder: int) -> None:
    """Take away a process's resources: without root it belongs to the student's user, who might take it over."""
    for which in (resource.RLIMIT_NPROC, resource.RLIMIT_FSIZE, resource.RLIMIT_NOFILE):
        resource.prlimit(holder, which, (0, 0))
    resource.prlimit(holder, resource.RLIMIT_AS, (_HOLDER_BYTES, _HOLDER_BYTES))


def _join(init: int, user_namespace: int) -> None:
    """Move this process into the namespaces of bubblewrap's first process."""
    opened = {name: os.open(f"/proc/{init}/ns/{name}", os.O_RDONLY) for name in ("ipc", "uts", "pid", "mnt")}
    syscalls.setns(user_namespace, syscalls.CLONE_NEWUSER)
    for namespace in opened.values():
        syscalls.setns(namespace)
        os.close(namespace)
    os.chdir("/")
