"""Runs a student's program through a scenario, in simulated time and in one interpreter with the rig.

The program waits in one place only, the wait set. That it waits means that it has nothing left to do: then, and only
then, the next thing happens. So there is no thread, no timing and no patience in it, and every run is the same. What
happens, and in which order, is what grader/runner/run.py does; the recording is the grader's own.
"""

from __future__ import annotations

import io
import linecache
import re
import sys
import threading
import time
import traceback
import types
from collections.abc import Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from dataclasses import dataclass
from typing import Any

from grader.exercise.exercise import Exercise
from grader.recording.recording import Ending, EndPoint, Received, Recording, Sent
from grader.runner.message import message_class, to_fields, to_message
from grader.scenario.scenario import SECOND, START, Message, Scenario
from rcl_python import cdr, logs, participant
from rcl_python import qos as quality
from rcl_python.context import interrupt
from rcl_python.graph import PUBLISHER, SERVICE, SUBSCRIPTION, NodeInfo
from rcl_python.link import Frame
from rcl_python.participant import Endpoint

#: As grader/runner/run.py.
AFTERWARDS = SECOND // 2
#: A program that only looks and never waits is done after so many looks.
_LOOKS = 4
_OFFER = quality.Profile(depth=1000)
_ACCEPT = quality.Profile(depth=10_000)
_MOST_MESSAGES = 5_000
_OWN_TO_ROS = ("/rosout", "/parameter_events")


class Over(BaseException):
    """Raised in the program when the scenario has ended. No program catches it by mistake."""


@dataclass(frozen=True)
class Program:
    """What a student wrote: the file's name and its text."""

    file: str
    source: str


class RigLink:
    """The link of a process in which nothing happens but what the rig does."""

    def __init__(self, idle: Any) -> None:
        self.lock = threading.Condition(threading.RLock())
        self._idle = idle
        self._steady = 0
        self._looks = 0

    def send(self, frame: Frame, data: bytes = b"") -> None:
        """Nobody else is there."""

    def receive(self) -> Iterator[tuple[Frame, bytes]]:
        """Nobody else says anything."""
        yield from ()

    def wait(self, nanoseconds: int | None) -> None:
        """The program has nothing left to do."""
        self._looks = 0
        self._steady += nanoseconds or 0
        self._idle()

    def breathe(self) -> None:
        """Count how often the program looks without waiting."""
        self._looks += 1
        if self._looks > _LOOKS:
            self.wait(0)

    def steady(self) -> int:
        """A clock that goes on by what the program waits for (ns)."""
        return self._steady

    def system(self) -> int:
        """The system clock (ns since the epoch): a program that asks for it gets it."""
        return time.time_ns()


class Rig:
    """One run of one program through one scenario."""

    def __init__(self, exercise: Exercise, scenario: Scenario, program: Program) -> None:
        self._exercise, self._scenario, self._program = exercise, scenario, program
        self._here = participant.use(RigLink(self._idle), "rig")
        self._now = 0
        self._steps = self._happenings()
        self._met = False
        self._sent: list[Sent] = []
        self._received: list[Received] = []
        self._nodes: tuple[str, ...] = ()
        self._end_points: tuple[EndPoint, ...] = ()
        self._hold: Any = "none"
        self._sim_time = False
        self._interrupted = False
        self._build()

    def _build(self) -> None:
        rig = self._here.add_node("rig", "/", 0, "/")
        reference = self._here.add_node(self._exercise.reference_node, "/", 0, "/")
        self._clock = self._publisher(rig, "/clock", "rosgraph_msgs/msg/Clock")
        self._publishers: dict[tuple[str, int], Endpoint] = {}
        for message in self._scenario.messages:
            key = (message.topic, message.publisher)
            if key not in self._publishers:
                self._publishers[key] = self._publisher(reference, message.topic, message.type)
        self._recorders = [
            (topic, self._here.add_endpoint(SUBSCRIPTION, rig, topic.name, topic.type, _modest(_ACCEPT)))
            for topic in self._exercise.outputs
        ]
        self._own = {rig.key, reference.key}
        self._speaking = {message.topic: message.publisher for message in reversed(self._scenario.messages)}

    def _publisher(self, node: NodeInfo, topic: str, kind: str) -> Endpoint:
        return self._here.add_endpoint(PUBLISHER, node, topic, kind, _OFFER)

    def run(self) -> Recording:
        """Run the program. Every fault of it is in the recording."""
        began = time.perf_counter()
        log = io.StringIO()
        with _as_main(self._program, log):
            ending = self._ending(log)
        self._take()
        seconds = time.perf_counter() - began
        return Recording(
            scenario=self._scenario.name,
            sent=tuple(self._sent),
            received=tuple(self._received),
            nodes=self._nodes,
            end_points=self._end_points or self._student_s_ends(),
            hold=self._hold,
            uses_sim_time=self._sim_time,
            ending=ending,
            log=log.getvalue(),
            seconds=seconds,
            lockstep_seconds=seconds,
        )

    def _ending(self, log: io.StringIO) -> Ending:
        try:
            code = compile(self._program.source, self._program.file, "exec")
            exec(code, sys.modules["__main__"].__dict__)
        except Over:
            return Ending("completed")
        except SystemExit as error:
            return self._ended(f"it gave up with exit code {error.code}." if error.code else _BY_ITSELF, None)
        except BaseException as error:
            return self._broke(error, log)
        return self._ended(_BY_ITSELF, None)

    def _broke(self, error: BaseException, log: io.StringIO) -> Ending:
        traceback.print_exception(type(error), error, _without_rig(error.__traceback__), file=log)
        words = "".join(traceback.format_exception_only(error)).strip().splitlines()[-1]
        if self._interrupted:
            return Ending("completed", interrupted=True, traceback=words)
        lines = [f.lineno for f in traceback.extract_tb(error.__traceback__) if f.filename == self._program.file]
        line = error.lineno if isinstance(error, SyntaxError) else lines[-1] if lines else None
        text = self._program.source.splitlines()[line - 1].strip() if line else ""
        place = f" in line {line}" if line else ""
        return self._ended(f"{words}{place}{f': {text}' if text else ''}", line)

    def _ended(self, why: str, line: int | None) -> Ending:
        """The ending of a program that ended by itself, in the grader's words (grader/runner/ending.py)."""
        if self._interrupted:
            return Ending("completed", interrupted=True)
        if self._met:
            return Ending("crashed", f"Your program ended at message {len(self._sent)}: {why}", line)
        return Ending("did-not-start", f"Your program did not start: {_NO_NODE if why == _BY_ITSELF else why}", line)

    def _idle(self) -> None:
        """The program waits: take what it has published, then let the next thing happen."""
        self._take()
        if next(self._steps, _END) is _END:
            raise Over

    def _happenings(self) -> Iterator[None]:
        self._look_round()
        self._set_clock(START)
        yield
        self._met = True
        for message in self._scenario.messages:
            if message.at > self._now:
                self._set_clock(message.at)
                yield
            self._publish(message)
            yield
        self._end_points = self._student_s_ends()
        self._set_clock(self._now + AFTERWARDS)
        yield
        if self._scenario.interrupt:
            self._interrupted = True
            interrupt("SIGINT")
        raise Over

    def _set_clock(self, now: int) -> None:
        self._now = now
        message = message_class("rosgraph_msgs/msg/Clock")()
        message.clock.sec, message.clock.nanosec = divmod(now, SECOND)
        self._clock.publish(cdr.serialize(message))

    def _publish(self, message: Message) -> None:
        former = self._speaking[message.topic]
        if former != message.publisher:
            self._publishers.pop((message.topic, former)).close()
            self._speaking[message.topic] = message.publisher
        publisher = self._publishers[message.topic, message.publisher]
        heard = bool(publisher.matched)
        self._sent.append(Sent(message.at, message.topic, message.type, message.fields, heard))
        publisher.publish(cdr.serialize(to_message(message.type, message.fields)))

    def _take(self) -> None:
        for topic, recorder in self._recorders:
            while (arrival := recorder.take()) is not None and len(self._received) < _MOST_MESSAGES:
                fields = to_fields(cdr.deserialize(arrival.data, message_class(topic.type)))
                self._received.append(Received(self._now, len(self._sent), topic.name, topic.type, fields))

    def _look_round(self) -> None:
        """See which nodes the program has made, and whether they take their time from /clock."""
        graph = self._here.graph
        nodes = [node for node in graph.nodes.values() if node.key not in self._own]
        self._nodes = tuple(sorted(_full_name(node) for node in nodes))
        self._hold = "lockstep" if nodes else "none"
        listening = {end.node for end in graph.ends(0, SUBSCRIPTION, topic="/clock")}
        asked = {end.node for end in graph.ends(0, SERVICE) if end.topic.endswith("/get_parameters")}
        self._sim_time = all(node.key in listening & asked for node in nodes)

    def _student_s_ends(self) -> tuple[EndPoint, ...]:
        graph = self._here.graph
        found = [
            EndPoint(_full_name(graph.nodes[end.node]), _KINDS[end.kind], end.topic, end.type, *_quality(end.qos))
            for end in graph.ends(0, PUBLISHER, SUBSCRIPTION)
            if end.node not in self._own and end.node in graph.nodes and end.topic not in _OWN_TO_ROS
        ]
        return tuple(sorted(found, key=lambda end: (end.topic, end.kind, end.node)))


_KINDS: dict[str, Any] = {PUBLISHER: "publisher", SUBSCRIPTION: "subscription"}
_END = object()
_BY_ITSELF = "it came to its end by itself, before it was asked to."
_NO_NODE = "it came to its end and created no node that spins. Is main() called, and does it call rclpy.spin()?"


def _modest(profile: quality.Profile) -> quality.Profile:
    """A profile that every publisher satisfies."""
    return quality.Profile(depth=profile.depth, reliability=quality.BEST_EFFORT)


def _full_name(node: NodeInfo) -> str:
    return f"{node.namespace.rstrip('/')}/{node.name}"


def _quality(profile: quality.Profile) -> tuple[str, str]:
    reliability = "best_effort" if profile.reliability == quality.BEST_EFFORT else "reliable"
    return reliability, "transient_local" if profile.durability == quality.TRANSIENT_LOCAL else "volatile"


def _without_rig(trace: types.TracebackType | None) -> types.TracebackType | None:
    while trace is not None and re.search(r"in_page[/\\]rig\.py$", trace.tb_frame.f_code.co_filename):
        trace = trace.tb_next
    return trace


def _forget_rclpy_s() -> None:
    """Let the next program find rclpy as it is after its import: a signal ends contexts behind rclpy's back."""
    import rclpy
    import rclpy.utilities

    rclpy.try_shutdown()
    rclpy.utilities.g_default_context = None
    vars(rclpy)["__executor"] = None


@contextmanager
def _as_main(program: Program, log: io.StringIO) -> Iterator[None]:
    """Let the program be `__main__`, started with simulated time; keep what it prints; clean up behind it."""
    before = sys.modules["__main__"], sys.argv, time.sleep, logs.write
    main = types.ModuleType("__main__")
    main.__file__ = program.file
    linecache.cache[program.file] = (
        len(program.source), None, program.source.splitlines(keepends=True), program.file
    )  # fmt: skip
    sys.modules["__main__"] = main
    sys.argv = [program.file, "--ros-args", "-p", "use_sim_time:=true"]
    time.sleep = lambda seconds: None
    logs.write = lambda line: print(line, file=log)
    try:
        with redirect_stdout(log), redirect_stderr(log):
            yield
    finally:
        sys.modules["__main__"], sys.argv, time.sleep, logs.write = before
        _forget_rclpy_s()
