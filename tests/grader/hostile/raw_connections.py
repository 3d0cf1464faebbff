"""Connections to the hub without the middleware. Attacks on the grader's own processes begin with this: see
on_the_grader.md.
"""

import array
import functools
import itertools
import os
import socket
import struct
import threading
import time

QOS = struct.pack("<BIBBBqqq", 1, 10, 1, 2, 1, 2**63 - 1, 2**63 - 1, 2**63 - 1)
PUBLISHER, SUBSCRIPTION, SERVER, CLIENT = range(4)
PIDS = itertools.count(10_000)


def frame(kind, payload=b""):
    return struct.pack("<IB", len(payload) + 1, ord(kind)) + payload


def text(value):
    return struct.pack("<I", len(value)) + value.encode()


def connect():
    asking, sent = socket.socketpair()
    with socket.socket(fileno=os.dup(1000)) as hub, sent:
        socket.send_fds(hub, [b"+"], [sent.fileno()])
    _, (number,), _, _ = socket.recv_fds(asking, 1, 1)
    return socket.socket(fileno=number)


class Raw:
    """A process that the hub takes for another one; its identities begin with `base`."""

    def __init__(self):
        self.socket = connect()
        self.handled = 0
        self.sent(frame("H", struct.pack("<IIIB", 3, next(PIDS), 1, 1)))

    def join(self):
        _, payload = self.read()
        self.base = struct.unpack_from("<I", payload, 4)[0] << 32
        self.handled = 1
        return self.sent(frame("J"), self.node())

    def sent(self, *frames):
        self.socket.sendall(b"".join(frames))
        return self

    def read(self):
        size, kind = struct.unpack("<IB", self._exactly(5))
        return chr(kind), self._exactly(size - 1)

    def _exactly(self, count):
        return self.socket.recv(count, socket.MSG_WAITALL) if count else b""

    def node(self, number=1, name="raw"):
        return frame("N", struct.pack("<Q", self.base | number) + text(name) + text("/"))

    def end(self, number, kind=PUBLISHER, topic="/x", type_name="std_msgs/msg/String", node=1):
        head = struct.pack("<QBQ", self.base | number, kind, self.base | node)
        return frame("E", head + text(topic) + text(type_name) + bytes(33) + QOS)

    def gone(self, number):
        return frame("e", struct.pack("<Q", self.base | number))

    def idle(self, next_=-1, runs=0, children=()):
        head = struct.pack("<QqqIIIBQH", self.handled, 2**60, next_, 1, 0, 0, 0, runs, len(children))
        return frame("I", head + array.array("I", children).tobytes())


def raws(count=1):
    """Return processes that have joined, with a node each."""
    return [raw.join() for raw in [Raw() for _ in range(count)]]


def attack(does):
    """Do it in another thread, so that the node itself stays honest."""

    def tries():
        try:
            does()
            time.sleep(3600)
        except (OSError, struct.error) as error:
            print("the attack ended:", error)

    threading.Thread(target=tries, daemon=True).start()
