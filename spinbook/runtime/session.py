"""What one notebook has while its kernel lives: a ROS domain, its nodes, a workspace, the package its cells make."""

from __future__ import annotations

import os
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

from spinbook.course.course import Package
from spinbook.package.files import Module
from spinbook.package.write import add_module
from spinbook.runtime import environment
from spinbook.runtime.domain import Domain
from spinbook.runtime.failure import CellFailed
from spinbook.runtime.node_registry import NodeRegistry, RunningNode, Stopped
from spinbook.runtime.process import KeptProcess
from spinbook.runtime.showing import Bound, in_short, show_for

#: How long a node's log is shown, and how long a command that does not end may run (s).
NODE_SECONDS = 3.0
COMMAND_SECONDS = 5.0
#: How long messages are counted for the graph (s).
GRAPH_SECONDS = 2.5
#: How long a bounded command may take to end by itself when it is told to (s): its last lines are wanted.
COMMAND_GRACE = (3.0, 1.0)


@dataclass
class Session:
    """The notebook's state. Processes that it starts run in `settings` on top of the kernel's own environment."""

    domain: Domain
    package: Package = field(default_factory=lambda: Package(name="notebook_nodes", workspace="notebook_ws"))
    nodes: NodeRegistry = field(default_factory=NodeRegistry)
    ran: dict[str, str] = field(default_factory=dict)
    """The code of each node's cell as it was run last, by the node's name."""
    ran_at: dict[str, float] = field(default_factory=dict)
    """When that was (s since the epoch)."""

    def __post_init__(self) -> None:
        self.use_domain(self.domain)

    def use_domain(self, domain: Domain) -> None:
        """Let everything that starts from now on talk in this domain, snippets in the kernel too."""
        self.domain = domain
        os.environ.update(environment.for_domain(domain.number, os.environ))
        if note := os.environ.get(environment.DOMAIN_NOTE):
            Path(note).write_text(str(domain.number), encoding="utf-8")

    @property
    def workspace(self) -> Path:
        """The colcon workspace: beside the notebook."""
        return Path.cwd() / self.package.workspace

    def run_node(self, name: str, code: str, bound: Bound, spin_class: str | None) -> None:
        """Write a node's code as a module of the package, start it and show its log for a while."""
        if self.package.name == name:
            raise CellFailed(f"A node can't have the package's name, {name}.")
        self.ran[name] = code
        self.ran_at[name] = time.time()
        module = add_module(self.workspace, self.package, Module(name, code.rstrip("\n") + "\n"))
        if spin_class:
            argv = [sys.executable, "-u", "-m", "spinbook.runtime.spin_class", os.fspath(module), spin_class]
        else:
            argv = [sys.executable, "-u", os.fspath(module)]
        self.run_background(name, argv, {}, Path.cwd(), bound)

    def run_background(self, name: str, argv: list[str], settings: dict[str, str], cwd: Path, bound: Bound) -> None:
        """Start a process that goes on behind the cell, and show its log for a while. Raises CellFailed."""
        if self.nodes.get(name) and self.nodes.status(name).running:
            print(f"(restarting {name})")
        node = self.nodes.start(name, argv, settings, cwd)
        self._show(node, bound)

    def _show(self, node: RunningNode, bound: Bound) -> None:
        try:
            show_for(node.process, bound, f": %log {node.name} shows them")
        except KeyboardInterrupt:
            print(f"\n{self.nodes.stop(node.name).in_words}")
            return
        status = node.process.status
        if status.exit is None:
            print(f"— {node.name} goes on in the background: %stop {node.name} ends it, %log {node.name} shows more —")
        elif status.exit == 0:
            print(f"— {node.name} has ended (exit code 0) —")
        else:
            raise CellFailed(f"{node.name} {_how_it_ended(status.exit)} Its last words are above.")

    def run_command(self, argv: list[str], settings: dict[str, str], cwd: Path, bound: Bound, shown_as: str) -> None:
        """Run a command in the cell; one that has not ended when its time is up is ended as Ctrl-C would.

        Raises CellFailed where it fails.
        """
        process = KeptProcess(argv, {**os.environ, **settings}, cwd)
        try:
            try:
                show_for(process, bound, "")
                bounded = process.status.running
            except KeyboardInterrupt:
                bounded = True
            if bounded:
                process.stop(COMMAND_GRACE)
                show_for(process, Bound(sum(COMMAND_GRACE) + 1), "")
        finally:
            process.close()
        status = process.status
        if bounded and status.ended_by == "SIGKILL":
            print(f"— {shown_as} ignored Ctrl-C and was killed —")
        elif not bounded and status.exit != 0:
            raise CellFailed(f"{shown_as}: {_how_it_ended(status.exit or 0)}")

    def log(self, name: str, whole: bool) -> str:
        """All that is kept of what a node printed. Raises CellFailed for a name that nothing has."""
        node = self.find(name)
        data, dropped = node.process.read_all()
        text = data.decode(errors="replace")
        if dropped:
            text += f"\n({dropped:,} bytes in the middle were too many to keep)"
        return text if whole else in_short(text)

    def find(self, name: str) -> RunningNode:
        """The node of that name. Raises CellFailed, naming those that there are."""
        node = self.nodes.get(name)
        if node is None:
            there = ", ".join(self.nodes.names()) or "none"
            raise CellFailed(f"This notebook has started no node `{name}`. Started are: {there}.")
        return node

    def stop(self, names: list[str] | None) -> list[Stopped]:
        """End these nodes, or all. Raises CellFailed for a name that nothing has."""
        for name in names or ():
            self.find(name)
        return self.nodes.stop_all(names)


def _how_it_ended(code: int) -> str:
    if code < 0:
        return f"was ended by signal {-code}."
    return f"ended with exit code {code}."
