"""The nodes that a notebook has started: their processes, how they end, and what goes wrong in them."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from spinbook.kernel.node_errors import NodeError, NodeLog, describe, ended_badly, how_it_ended
from spinbook.kernel.process import STOP_GRACE, KeptProcess, Status

#: How long a report of an exception that ends its program waits for that end (s), so that it can say both.
_ENDING_S = 10.0


@dataclass
class RunningNode:
    """A node that was started and may have ended since. `expects_error` says that its errors are meant."""

    name: str
    process: KeptProcess
    expects_error: bool = False
    files: tuple[str, ...] = ()
    """Its programs, if they are in Python."""
    log: NodeLog = field(default_factory=NodeLog)
    read_to: int = 0
    end_is_reported: bool = False

    def errors(self, *, stopped: bool = False) -> NodeError | None:
        """Return what has gone wrong since the last call; `stopped` says that this notebook has ended it since."""
        text = self._new_output()
        self.log.add(text, stopping=stopped)
        if self.log.is_ending and not stopped:
            self.process.wait(_ENDING_S)
            self.log.add(self._new_output())
        status = self.process.status
        bad = ended_badly(status.exit, stopped=stopped, interrupted=self.log.was_interrupted)
        ended = how_it_ended(status.exit or 0) if bad and not self.end_is_reported else ""
        self.end_is_reported = self.end_is_reported or not status.running
        return describe(self.name, self.log, ended, files=self.files, meant=self.expects_error)

    def _new_output(self) -> str:
        data, _, self.read_to = self.process.read_from(self.read_to)
        return data.decode(errors="replace")


@dataclass(frozen=True)
class StopResult:
    """How a node ended when it was stopped. `error` is what went wrong, if anything did."""

    name: str
    status: Status
    had_ended: bool
    error: NodeError | None = None

    @property
    def in_words(self) -> str:
        """The result in one line, for the reader."""
        code, by = self.status.exit, self.status.ended_by
        if self.had_ended:
            return f"{self.name} had ended before (exit code {code})."
        if by == "SIGKILL":
            return f"{self.name} ignored Ctrl-C and SIGTERM for {sum(STOP_GRACE):g} s; it was killed."
        if self.error is None or code == 0:
            late = f", but only after {STOP_GRACE[0]:g} s and SIGTERM" if by == "SIGTERM" else ""
            return f"{self.name} stopped{late}."
        return f"{self.name} stopped with exit code {code}; a node that ends normally has 0."


class NodeRegistry:
    """The nodes that this notebook started and did not replace or stop."""

    def __init__(self) -> None:
        self._nodes: dict[str, RunningNode] = {}
        self._errors: list[NodeError] = []

    def start(
        self, name: str, argv: Sequence[str], settings: Mapping[str, str], cwd: Path, *, expects_error: bool = False
    ) -> RunningNode:
        """Start a process under this name; one that has the name already is stopped first. `expects_error` says that
        its errors are meant."""
        if name in self._nodes:
            self.stop(name)
        files = tuple(word for word in argv if word.endswith(".py"))
        node = RunningNode(name, KeptProcess(argv, {**os.environ, **settings}, cwd), expects_error, files)
        self._nodes[name] = node
        return node

    def get(self, name: str) -> RunningNode | None:
        """Return the node of that name, running or ended."""
        return self._nodes.get(name)

    def names(self) -> list[str]:
        """Return the names, in the order in which they were started."""
        return list(self._nodes)

    def status(self, name: str) -> Status:
        """Return the current status of a node."""
        return self._nodes[name].process.wait(0)

    def new_errors(self) -> list[NodeError]:
        """Return what has gone wrong in nodes since the last call, also in those that were stopped since."""
        running = [error for node in self._nodes.values() if (error := node.errors())]
        errors, self._errors = [*self._errors, *running], []
        return errors

    def stop(self, name: str) -> StopResult:
        """End a node as Ctrl-C would, or by force if that does not help, and forget it."""
        return self.stop_all([name])[0]

    def stop_all(self, names: Sequence[str] | None = None) -> list[StopResult]:
        """End these nodes (all without `names`) at the same time, and forget them."""
        chosen = [self._nodes.pop(name) for name in (self.names() if names is None else names)]
        had_ended = list(self._begin_to_stop(chosen))
        return [self._stopped(node, ended) for node, ended in zip(chosen, had_ended, strict=True)]

    def _begin_to_stop(self, nodes: Sequence[RunningNode]) -> Iterator[bool]:
        """Ask each node to end; yield whether it had ended before."""
        for node in nodes:
            if error := node.errors():
                self._errors.append(error)
            ended = not node.process.status.running
            if not ended:
                node.process.stop()
            yield ended

    def _stopped(self, node: RunningNode, had_ended: bool) -> StopResult:
        status = node.process.wait(sum(STOP_GRACE) + 5)
        error = node.errors(stopped=not had_ended)
        self._errors += [error] if error else []
        node.process.close()
        return StopResult(node.name, status, had_ended, error)
