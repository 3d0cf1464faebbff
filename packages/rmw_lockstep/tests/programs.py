"""Real programs with rclpy over the compiled middleware, and a hub that only watches and advances time."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import textwrap
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from rclpy.serialization import deserialize_message, serialize_message
from std_msgs.msg import String

from rmw_lockstep.hub import BEGIN, Hub, QosPolicies
from rmw_lockstep.library import Library, library
from rmw_lockstep.qos import BEST_EFFORT, KEEP_ALL

SECOND = 1_000_000_000
MS = 1_000_000

#: How long a program may take for a request, on a busy machine, before a test gives up (s).
LONGEST_S = 60.0

#: What every program begins with: `say(text)` publishes on /said.
PROLOGUE = """
import os, sys, threading, time
import rclpy
from rclpy.executors import *
from rclpy.node import Node
from rclpy.qos import *
from std_msgs.msg import String
rclpy.init(args=[])
node = rclpy.create_node('talker')
publisher = node.create_publisher(String, '/said', 100)
def say(text): publisher.publish(String(data=str(text)))
"""


def text(cdr: bytes) -> str:
    """Return the text of a serialized std_msgs/msg/String."""
    message: Any = deserialize_message(cdr, String)
    return str(message.data)


def serialized(text: str) -> bytes:
    """The same text as a serialized std_msgs/msg/String."""
    return bytes(serialize_message(String(data=text)))


class Program:
    """One program, started from the text of its source, and what it says on /said."""

    def __init__(self, hub: Hub, folder: Path, source: str, *arguments: str) -> None:
        found = library()
        assert isinstance(found, Library), f"the middleware is not compiled: {found}"
        file = folder / f"program_{len(list(folder.iterdir()))}.py"
        file.write_text(PROLOGUE + textwrap.dedent(source))
        environment = {**os.environ, "RMW_LOCKSTEP_SOCKET": str(hub.path), "LTTNG_UST_REGISTER_TIMEOUT": "0"}
        # The environment's ROS libraries come after ours.
        environment |= found.environment(environment)
        self.process = subprocess.Popen(
            [sys.executable, str(file), *arguments],
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )

    def end(self) -> None:
        """End it, and everything it has started."""
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()

    def output(self) -> str:
        """Return everything it printed; this ends it."""
        self.end()
        return str(self.process.communicate()[0])


class Watch:
    """A hub with one subscription to /said. Use it as a context manager."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._programs: list[Program] = []
        self._deadline = time.monotonic() + LONGEST_S
        self.hub = Hub(folder, on_tick=self._look)
        self.node = self.hub.node("watch")
        hears_all = QosPolicies(history=KEEP_ALL, reliability=BEST_EFFORT)
        self._said = self.node.subscription("/said", "std_msgs/msg/String", hears_all)

    def _look(self) -> None:
        for program in self._programs:
            if program.process.poll() not in (None, 0):
                raise AssertionError(f"the program ended with {program.process.returncode}:\n{program.output()}")
        if self._programs and not self.hub.links and all(p.process.poll() == 0 for p in self._programs):
            raise EOFError
        if time.monotonic() > self._deadline:
            outputs = [program.output() for program in self._programs]
            raise AssertionError(
                f"not idle after {LONGEST_S:g} s: {[link.last_idle for link in self.hub.links]} {outputs}"
            )

    def start(self, source: str, *arguments: str) -> Program:
        """Start a program that the hub waits for."""
        program = Program(self.hub, self._folder, source, *arguments)
        self._programs.append(program)
        if self.hub.main is None:
            self.hub.main = program.process.pid
        return program

    def go_on(self, seconds: float) -> None:
        """Wait until everything is idle, and advance time this far. A program may end meanwhile."""
        try:
            self.hub.wait_until_idle()
            self.hub.advance(self.hub.now + round(seconds * SECOND))
            self.hub.wait_until_idle()
        except EOFError:
            self.hub.drain()

    def go_until(self, done: Callable[[], object], step: float = 0.05) -> None:
        """Advance time, step by step, until a condition is true: a program that has just been started needs time."""
        while not done():
            self.go_on(step)

    @property
    def elapsed_s(self) -> float:
        """How far time has been advanced so far."""
        return (self.hub.now - BEGIN) / SECOND

    def said(self) -> list[tuple[float, str]]:
        """Return what was said, and when: milliseconds since the beginning."""
        return [((heard.now - BEGIN) / MS, text(heard.cdr)) for heard in self._said.heard]

    def ordered(self) -> dict[str, bool]:
        """Return what was said, and whether it has an order among what the same node says."""
        return {text(heard.cdr): heard.ordered for heard in self._said.heard}

    def __enter__(self) -> Watch:
        self.hub.__enter__()
        return self

    def __exit__(self, *error: Any) -> None:
        for program in self._programs:
            program.end()
            if program.process.stdout:
                program.process.stdout.close()
        self.hub.__exit__(*error)
