"""The processes of a notebook, by name: started, replaced, listed, stopped."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from spinbook.runtime.process import STOP_GRACE, KeptProcess, Status


@dataclass
class RunningNode:
    """A node that was started, and may have ended since."""

    name: str
    process: KeptProcess


@dataclass(frozen=True)
class Stopped:
    """How a node ended when it was told to. `said` is what it printed after it was told."""

    name: str
    status: Status
    said: str
    had_ended: bool

    @property
    def in_words(self) -> str:
        """One line for the reader."""
        code, by = self.status.exit, self.status.ended_by
        if self.had_ended:
            return f"{self.name} had ended before (exit code {code})."
        if by == "SIGKILL":
            return f"{self.name} ignored Ctrl-C and SIGTERM for {sum(STOP_GRACE):g} s; it was killed."
        if code == 0 or (code is not None and code < 0):
            late = f", but only after {STOP_GRACE[0]:g} s and SIGTERM" if by == "SIGTERM" else ""
            return f"{self.name} stopped{late}."
        return f"{self.name} stopped with exit code {code}; a node that ends in order has 0."


class NodeRegistry:
    """Every node that this notebook started and did not replace or stop."""

    def __init__(self) -> None:
        self._nodes: dict[str, RunningNode] = {}

    def start(self, name: str, argv: Sequence[str], settings: Mapping[str, str], cwd: Path) -> RunningNode:
        """Start a process under this name; one that has the name already is stopped first."""
        if name in self._nodes:
            self.stop(name)
        node = RunningNode(name, KeptProcess(argv, {**os.environ, **settings}, cwd))
        self._nodes[name] = node
        return node

    def get(self, name: str) -> RunningNode | None:
        """The node of that name, running or ended."""
        return self._nodes.get(name)

    def names(self) -> list[str]:
        """The names, in the order in which they were started."""
        return list(self._nodes)

    def status(self, name: str) -> Status:
        """Where a node stands now."""
        return self._nodes[name].process.wait(0)

    def stop(self, name: str) -> Stopped:
        """End a node as Ctrl-C would, harder where that does not help, and forget it."""
        return self.stop_all([name])[0]

    def stop_all(self, names: Sequence[str] | None = None) -> list[Stopped]:
        """End these nodes (all without `names`) at the same time, and forget them."""
        chosen = [self._nodes.pop(name) for name in (self.names() if names is None else names)]
        had_ended = []
        for node in chosen:
            node.process.read()
            had_ended.append(not node.process.status.running)
            if not had_ended[-1]:
                node.process.stop()
        stopped = []
        for node, ended in zip(chosen, had_ended, strict=True):
            status = node.process.wait(sum(STOP_GRACE) + 5)
            said, _ = node.process.read()
            node.process.close()
            stopped.append(Stopped(node.name, status, said.decode(errors="replace"), ended))
        return stopped
