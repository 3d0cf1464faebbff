"""Watches the graph while a notebook runs, and makes one graph of what was seen after each cell."""

from __future__ import annotations

import asyncio
import contextlib
import ctypes
import os
import signal
import sys
from asyncio.subprocess import DEVNULL, PIPE, Process
from pathlib import Path

from spinbook.graph.model import End, NodeGraph, SeenNode, Topic
from spinbook.kernel.environment import for_domain


class History:
    """Everything that was there at the end of some cell."""

    def __init__(self) -> None:
        self._nodes: dict[str, tuple[str, str]] = {}
        self._publishers: dict[str, dict[tuple[str, str], bool]] = {}
        self._subscriptions: dict[str, dict[tuple[str, str], bool]] = {}
        self._rates: dict[str, float] = {}

    def add(self, cell: str, graph: NodeGraph) -> None:
        """What was seen at the end of a cell."""
        for node in graph.nodes:
            first, _ = self._nodes.get(node.name, (cell, cell))
            self._nodes[node.name] = (first, cell)
        for topic in graph.topics:
            _merge(self._publishers.setdefault(topic.name, {}), topic.publishers)
            _merge(self._subscriptions.setdefault(topic.name, {}), topic.subscriptions)
            if topic.rate_hz is not None:
                self._rates[topic.name] = topic.rate_hz

    def graph(self) -> NodeGraph:
        """All of it, nodes in the order in which they came.

        Ends that were connected at some time are, and a topic's rate is the last one counted.
        """
        nodes = (SeenNode(name, first, last) for name, (first, last) in self._nodes.items())
        topics = (
            Topic(name, _ends(self._publishers[name]), _ends(self._subscriptions[name]), self._rates.get(name))
            for name in sorted(self._publishers)
        )
        return NodeGraph(tuple(nodes), tuple(topics))


def _merge(ends: dict[tuple[str, str], bool], more: tuple[End, ...]) -> None:
    for end in more:
        ends[end.node, end.type] = end.connected or ends.get((end.node, end.type), False)


def _ends(ends: dict[tuple[str, str], bool]) -> tuple[End, ...]:
    return tuple(sorted(End(node, kind, connected) for (node, kind), connected in ends.items()))


#: Cells during which messages may be counted: no command and no snippet looks at the graph meanwhile.
COUNTED_CELLS = ("%%node", "%plot")
#: An observer that has not answered for so long (s) is given up: the notebook matters more than its picture.
_TIME_LIMIT_S = 60.0
_PR_SET_PDEATHSIG = 1


class GraphWatch:
    """Follows the notebook whose kernel writes its ROS domain into the file `note`.

    Where the graph can't be watched, nothing is seen and nothing fails.
    """

    def __init__(self, note: Path) -> None:
        self._note = note
        self._history = History()
        self._domain = ""
        self._observer: Process | None = None

    async def start(self) -> None:
        """Start the observer, which gets ready while the kernel does."""
        environment = {**os.environ, **for_domain(0, os.environ)}
        argv = (sys.executable, "-m", "spinbook.graph.observer")
        self._observer = await asyncio.create_subprocess_exec(
            *argv, env=environment, stdin=PIPE, stdout=PIPE, stderr=DEVNULL, limit=1 << 24, preexec_fn=_die_with_parent
        )

    async def cell_begins(self, source: str) -> None:
        """A cell is about to run."""
        if self._domain and source.startswith(COUNTED_CELLS):
            self._tell("count")

    async def cell_ends(self, cell: str) -> None:
        """The cell with this id has run: what is there now belongs to it."""
        if not self._follow() or self._observer is None or self._observer.stdout is None:
            return
        try:
            self._tell("look")
            line = await asyncio.wait_for(self._observer.stdout.readline(), _TIME_LIMIT_S)
            self._history.add(cell, NodeGraph.from_json(line.decode()))
        except (ValueError, OSError, asyncio.TimeoutError):
            await self.close()

    def _follow(self) -> bool:
        """Let the domain be observed in which the notebook's nodes talk; whether they talk in any yet."""
        with contextlib.suppress(OSError):
            domain = self._note.read_text(encoding="utf-8")
            if domain != self._domain:
                self._domain = domain
                self._tell(f"domain {domain}")
        return bool(self._domain)

    def _tell(self, word: str) -> None:
        if self._observer is not None and self._observer.stdin is not None:
            self._observer.stdin.write(f"{word}\n".encode())

    async def close(self) -> None:
        """End the observer."""
        observer, self._observer = self._observer, None
        if observer is not None:
            with contextlib.suppress(ProcessLookupError):
                observer.kill()
            await observer.wait()

    @property
    def graph(self) -> NodeGraph | None:
        """What has been seen of the chapter so far; None if nothing."""
        graph = self._history.graph()
        return graph if graph.nodes else None


def _die_with_parent() -> None:
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL, 0, 0, 0)
