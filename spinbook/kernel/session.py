"""The state of a notebook while its kernel runs: its ROS domain, nodes, workspace and package."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from spinbook.chapter.complete_program import join
from spinbook.chapter.launch_files import is_package_file
from spinbook.chapter.python_code import CodeError
from spinbook.course.course import Package
from spinbook.kernel import environment
from spinbook.kernel.cell_output import DisplayLimit, in_short, joins, show_for, show_rest
from spinbook.kernel.environment import Domain
from spinbook.kernel.process import STOP_GRACE, CellFailed, KeptProcess, Status
from spinbook.kernel.timeline_cell import TimelineProcess
from spinbook.package.files import Module
from spinbook.package.workspace import add_file, add_module


@dataclass
class RunningNode:
    """A node that was started and may have ended since."""

    name: str
    process: KeptProcess


@dataclass(frozen=True)
class StopResult:
    """How a node ended when it was stopped. `output` is what it printed after that."""

    name: str
    status: Status
    output: str
    had_ended: bool

    @property
    def in_words(self) -> str:
        """The result in one line, for the reader."""
        code, by = self.status.exit, self.status.ended_by
        if self.had_ended:
            return f"{self.name} had ended before (exit code {code})."
        if by == "SIGKILL":
            return f"{self.name} ignored Ctrl-C and SIGTERM for {sum(STOP_GRACE):g} s; it was killed."
        if code == 0 or (code is not None and code < 0):
            late = f", but only after {STOP_GRACE[0]:g} s and SIGTERM" if by == "SIGTERM" else ""
            return f"{self.name} stopped{late}."
        return f"{self.name} stopped with exit code {code}; a node that ends normally has 0."


class NodeRegistry:
    """The nodes that this notebook started and did not replace or stop."""

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
        """Return the node of that name, running or ended."""
        return self._nodes.get(name)

    def names(self) -> list[str]:
        """Return the names, in the order in which they were started."""
        return list(self._nodes)

    def status(self, name: str) -> Status:
        """Return the current status of a node."""
        return self._nodes[name].process.wait(0)

    def stop(self, name: str) -> StopResult:
        """End a node as Ctrl-C would, or by force if that does not help, and forget it."""
        return self.stop_all([name])[0]

    def stop_all(self, names: Sequence[str] | None = None) -> list[StopResult]:
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
            output, _ = node.process.read()
            node.process.close()
            stopped.append(StopResult(node.name, status, output.decode(errors="replace"), ended))
        return stopped


#: How long a node's log is shown, and how long a command that does not end may run (s).
NODE_SECONDS = 3.0
COMMAND_SECONDS = 5.0
#: How long `%log --until` waits at most (s).
LOG_SECONDS = 30.0
#: The time between two looks at the log (s).
_LOG_POLL_S = 0.1
#: How long messages are counted for the graph (s).
GRAPH_SECONDS = 2.5
#: The time that a command has to end after Ctrl-C, and then after SIGTERM (s), so that its last lines are shown.
COMMAND_GRACE = (3.0, 1.0)


@dataclass(frozen=True)
class NodeStart:
    """How a node's code is started: by itself, by its `main`, or by spinning these classes.

    `known_as` are the names `PACKAGE/EXECUTABLE` by which `ros2 run` finds it.
    """

    classes: tuple[str, ...] = ()
    calls_main: bool = False
    known_as: tuple[str, ...] = ()

    def argv(self, file: Path, words: Sequence[str] = ()) -> list[str]:
        """Return the command that starts the code in `file`; `words` are the node's arguments."""
        own = [part for name in self.classes for part in ("--class", name)]
        own = ["--main"] if self.calls_main else own
        if not own:
            return [sys.executable, "-u", os.fspath(file), *words]
        return [sys.executable, "-u", "-m", "spinbook.kernel.entry", os.fspath(file), *own, "--", *words]


@dataclass
class Session:
    """The notebook's state. Processes that it starts run in `settings` on top of the kernel's own environment."""

    domain: Domain
    package: Package = field(default_factory=lambda: Package(name="notebook_nodes", workspace="notebook_ws"))
    nodes: NodeRegistry = field(default_factory=NodeRegistry)
    ran: dict[str, str] = field(default_factory=dict)
    """The code of each node's cell as it last ran, by the node's name."""
    ran_at: dict[str, float] = field(default_factory=dict)
    """When that was (s since the epoch)."""
    parts: dict[str, str] = field(default_factory=dict)
    """Code that later nodes use, by its name."""
    starts: dict[str, tuple[Path, NodeStart]] = field(default_factory=dict)
    """The file of each node and how it is started, by the node's name."""
    timeline: TimelineProcess | None = None
    """The recorder for `%timeline`, if one is running."""

    def __post_init__(self) -> None:
        self.use_domain(self.domain)

    def use_domain(self, domain: Domain) -> None:
        """Let everything that starts from now on use this domain, including snippets in the kernel."""
        self.domain = domain
        for name in environment.OF_OTHER_NETWORKS:
            os.environ.pop(name, None)
        os.environ.update(environment.for_domain(domain.number, os.environ))
        if note := os.environ.get(environment.DOMAIN_NOTE):
            Path(note).write_text(str(domain.number), encoding="utf-8")

    @property
    def workspace(self) -> Path:
        """The colcon workspace, next to the notebook."""
        return Path.cwd() / self.package.workspace

    def run_node(
        self,
        name: str,
        code: str,
        bound: DisplayLimit,
        start: NodeStart | None = None,
        after: Sequence[str] | None = None,
    ) -> None:
        """Write a node's code as a module of its package, start it and show its log for a while.

        `after` names the nodes and parts whose code completes it; None if it is complete.
        """
        start = start or NodeStart()
        file = self._saved(name, code, start, after)
        self.run_background(name, start.argv(file), self._import_path(file), Path.cwd(), bound)

    def keep_node(self, name: str, code: str, start: NodeStart, after: Sequence[str] | None = None) -> None:
        """Write a node's code as a module of its package, for `ros2 run` to start with arguments."""
        known_as = start.known_as or (f"{self.package.name}/{name}",)
        self._saved(name, code, replace(start, known_as=known_as), after)
        package, _, executable = known_as[0].partition("/")
        print("— saved, not started: it reads command-line arguments. Start it with them:")
        print(f"  %ros2 run {package} {executable} …")

    def _saved(self, name: str, code: str, start: NodeStart, after: Sequence[str] | None) -> Path:
        package, executables = self._package_of(start.known_as)
        if package.name == name:
            raise CellFailed(f"A node can't have the package's name, {name}.")
        self.ran[name] = code
        self.ran_at[name] = time.time()
        whole = code if after is None else self._whole(code, after)
        module = Module(name, whole.rstrip("\n") + "\n", executables)
        file = add_module(self.workspace, package, module)
        self.starts[name] = (file, start)
        return file

    def write_file(self, path: str, text: str) -> None:
        """Put a launch or parameter file into the package. Raises CellFailed for any other path."""
        if not is_package_file(path):
            raise CellFailed(
                f"`{path}` is not a launch or parameter file. Write launch/NAME.launch.py or config/NAME.yaml."
            )
        file = add_file(self.workspace, self.package, path, text.rstrip("\n") + "\n")
        print(f"Wrote {file.relative_to(Path.cwd())}")

    def _package_of(self, known_as: Sequence[str]) -> tuple[Package, tuple[str, ...]]:
        """Return the package to which a node belongs, and the names of its executables there."""
        pairs = [name.partition("/") for name in known_as]
        if not pairs:
            return self.package, ()
        package = pairs[0][0]
        executables = tuple(executable for name, _, executable in pairs if name == package)
        return (self.package if package == self.package.name else replace(self.package, name=package)), executables

    def _whole(self, code: str, after: Sequence[str]) -> str:
        pieces = []
        for name in after:
            piece = self.parts.get(name, self.ran.get(name))
            if piece is None:
                raise CellFailed(f"This node uses what `{name}` defines: run its cell above first.")
            pieces.append(piece)
        try:
            return join(code, pieces).whole
        except CodeError:
            # Python's own message is the clearest.
            return code

    def _import_path(self, module: Path) -> dict[str, str]:
        """Return settings with which nodes can import each other by their package, as they can once it is installed."""
        paths = [os.fspath(module.parents[1]), *os.environ.get("PYTHONPATH", "").split(os.pathsep)]
        return {"PYTHONPATH": os.pathsep.join(path for path in paths if path)}

    def run_executable(
        self, package: str, executable: str, words: Sequence[str], bound: DisplayLimit, known_as: str
    ) -> bool:
        """Start the node that a cell made as this executable. Return whether there is one.

        `known_as` differs from the executable's name if another instance has that name.
        """
        for name, (file, start) in self.starts.items():
            if f"{package}/{executable}" in start.known_as:
                instance = name if known_as == executable else known_as
                self.run_background(instance, start.argv(file, words), self._import_path(file), Path.cwd(), bound)
                return True
        return False

    def run_background(
        self, name: str, argv: list[str], settings: dict[str, str], cwd: Path, bound: DisplayLimit
    ) -> None:
        """Start a process that continues in the background, and show its log for a while. Raises CellFailed."""
        if self.nodes.get(name):
            if self.nodes.status(name).running:
                print(f"(restarting {name})")
            self.nodes.stop(name)
        node = self.nodes.start(name, argv, settings, cwd)
        self._show(node, bound)

    def _show(self, node: RunningNode, bound: DisplayLimit) -> None:
        has_joined = joins(node.process, self.domain.number)
        try:
            show_for(node.process, bound, f": %log {node.name} shows them", has_joined)
        except KeyboardInterrupt:
            print(f"\n{self.nodes.stop(node.name).in_words}")
            return
        status = node.process.status
        if status.exit is None:
            print(
                f"— {node.name} continues in the background: %stop {node.name} ends it, %log {node.name} shows more —"
            )
        elif status.exit == 0:
            print(f"— {node.name} has ended (exit code 0) —")
        else:
            raise CellFailed(f"{node.name} {_how_it_ended(status.exit)} Its last output is above.")

    def run_command(
        self, argv: list[str], settings: dict[str, str], cwd: Path, bound: DisplayLimit, shown_as: str
    ) -> None:
        """Run a command in the cell, and end it as Ctrl-C would when its time is up. Raises CellFailed if it fails."""
        process = KeptProcess(argv, {**os.environ, **settings}, cwd)
        try:
            try:
                show_for(process, bound, "", joins(process, self.domain.number))
                bounded = process.status.running
            except KeyboardInterrupt:
                bounded = True
            if bounded:
                process.stop(COMMAND_GRACE)
                show_rest(process, sum(COMMAND_GRACE) + 1)
        finally:
            process.close()
        status = process.status
        if bounded and status.ended_by == "SIGKILL":
            print(f"— {shown_as} ignored Ctrl-C and was killed —")
        elif not bounded and status.exit != 0:
            raise CellFailed(f"{shown_as}: {_how_it_ended(status.exit or 0)}")

    def wait_for(self, name: str, bound: DisplayLimit) -> None:
        """Wait until a node's log contains the limit's text, or time is up. Raises CellFailed for an unknown name."""
        node = self.find(name)
        deadline = time.monotonic() + bound.seconds
        text = (bound.until or "").encode()
        while text not in node.process.read_all()[0]:
            if not node.process.status.running or time.monotonic() >= deadline:
                print(f"({name} did not print {bound.until!r} within {bound.seconds:g} s)")
                return
            time.sleep(_LOG_POLL_S)

    def log(self, name: str, whole: bool) -> str:
        """Return the output of a node that was kept. Raises CellFailed for an unknown name."""
        node = self.find(name)
        data, dropped = node.process.read_all()
        text = data.decode(errors="replace")
        if dropped:
            text += f"\n({dropped:,} bytes in the middle were not kept)"
        return text if whole else in_short(text)

    def find(self, name: str) -> RunningNode:
        """Return the node of that name. Raises CellFailed, which lists the known ones."""
        node = self.nodes.get(name)
        if node is None:
            there = ", ".join(self.nodes.names()) or "none"
            raise CellFailed(f"This notebook has not started a node `{name}`. Started: {there}.")
        return node

    def stop(self, names: list[str] | None) -> list[StopResult]:
        """End these nodes, or all. Raises CellFailed for an unknown name."""
        for name in names or ():
            self.find(name)
        return self.nodes.stop_all(names)


def _how_it_ended(code: int) -> str:
    if code < 0:
        return f"was ended by signal {-code}."
    return f"ended with exit code {code}."
