"""The state of a notebook while its kernel runs: its ROS domain, nodes, workspace and package."""

from __future__ import annotations

import itertools
import os
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from interface_compiler import prefixes
from spinbook.chapter.complete_program import join
from spinbook.chapter.launch_files import is_package_file
from spinbook.chapter.python_code import CodeError, facts_of
from spinbook.course.course import Package
from spinbook.kernel import environment
from spinbook.kernel.cell_output import DisplayLimit, in_short, joins, show_for, show_rest
from spinbook.kernel.environment import Domain
from spinbook.kernel.long_lines import whole_in
from spinbook.kernel.node_errors import AS_EXPECTED, NodeError, how_it_ended
from spinbook.kernel.node_registry import NodeRegistry, RunningNode, StopResult
from spinbook.kernel.process import KeptProcess, Status
from spinbook.kernel.reader_frames import magic_comment, readable
from spinbook.kernel.silent_errors import SilentErrors
from spinbook.kernel.timeline_cell import TimelineProcess
from spinbook.package.cell_line import CellFailed
from spinbook.package.files import Module
from spinbook.package.workspace import add_file, add_module

#: How long a command that does not end may run (s).
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
    """How a node's code is started: by itself, by its `main`, or by spinning these classes, or calling `Class.method`.

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
    silent: SilentErrors = field(default_factory=SilentErrors)
    ran: dict[str, str] = field(default_factory=dict)
    """The code of each node's cell as it last ran, by the node's name."""
    ran_at: dict[str, float] = field(default_factory=dict)
    """When that was (s since the epoch)."""
    parts: dict[str, str] = field(default_factory=dict)
    """Code that later nodes use, by its name."""
    earlier: dict[str, str] = field(default_factory=dict)
    """The earlier version of each node whose newer one has no `main` of its own."""
    runs: dict[str, str] = field(default_factory=dict)
    """The code with which each node was last started, by the node's name."""
    starts: dict[str, tuple[Path, NodeStart]] = field(default_factory=dict)
    """The file of each node and how it is started, by the node's name."""
    head: int = 1
    """How many lines the current cell has above its code: that of its magic, and empty ones."""
    expects_error: bool = False
    """Whether a command of the current cell says that errors of nodes are meant."""
    run_here: list[str] = field(default_factory=list)
    """The names under which `ros2 run` has started nodes in the current cell."""
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
        self, name: str, code: str, bound: DisplayLimit, start: NodeStart, after: Sequence[str] | None
    ) -> None:
        """Save a node, start it and show its log for a while; `after` as in `save_node`."""
        file = self.save_node(name, code, start, after)
        self.run_background(name, start.argv(file), self._import_path(file), Path.cwd(), bound)

    def restart(self, name: str, words: Sequence[str]) -> RunningNode:
        """Start a cell's node again as its cell last ran, with these arguments, and show nothing of it."""
        file, start = self.starts[name]
        return self.nodes.start(name, start.argv(file, words), self._import_path(file), Path.cwd())

    def replace_node(self, earlier: str | None) -> None:
        """Stop the earlier version of a node that is about to start, and say so; None if there is none."""
        if earlier is not None and self.nodes.get(earlier):
            print(f"(replaces {earlier}, the earlier version of this node)")
            self.nodes.stop(earlier)

    def keep_node(self, name: str, code: str, start: NodeStart, after: Sequence[str] | None) -> None:
        """Save a node for `ros2 run` to start with arguments; `after` as in `save_node`."""
        known_as = start.known_as or (f"{self.package.name}/{name}",)
        self.save_node(name, code, replace(start, known_as=known_as), after)
        if start.classes:
            print(f"— saved, not started: nothing here calls {start.classes[0]}, which spins —")
            return
        package, _, executable = known_as[0].partition("/")
        print("— saved, not started: it reads command-line arguments. Start it with them:")
        print(f"  %ros2 run {package} {executable} …")

    def save_node(self, name: str, code: str, start: NodeStart, after: Sequence[str] | None = None) -> Path:
        """Write a node's code as a module of its package, for `ros2 run` to start. Return its file.

        `after` names the nodes and parts whose code completes it; None if it is complete. Raises CellFailed.
        """
        package, executables = self._package_of(start.known_as)
        if package.name == name:
            raise CellFailed(f"A node can't have the package's name, {name}.")
        if name in (after or ()):
            self._keep_earlier(name)
        self.ran[name] = code
        self.ran_at[name] = time.time()
        whole = code if after is None else self._whole(name, code, after)
        # Below its magic, code has the numbers that the notebook shows next to its lines.
        above, is_whole = whole.removesuffix(code), whole == code
        magic = magic_comment(name, 0 if is_whole else self.head)
        whole = "\n" * (self.head - 1) * is_whole + f"{above}{magic}\n{code}" if whole.endswith(code) else whole
        module = Module(name, whole.rstrip("\n") + "\n", executables)
        file = add_module(self.workspace, package, module)
        self.starts[name] = (file, start)
        return file

    def instance(self, name: str) -> str:
        """Return the name of a node that `ros2 run` starts: one of its own if the cell has one that still runs."""
        names = (name if count == 1 else f"{name}_{count}" for count in itertools.count(1))
        free = next(name for name in names if name not in self.run_here or not self._runs(name))
        self.run_here.append(free)
        return free

    def _runs(self, name: str) -> bool:
        node = self.nodes.get(name)
        return node is not None and node.process.status.running

    def new_errors(self) -> list[NodeError]:
        """Return what has newly gone wrong in nodes, or silently in cells; meant if its commands expected it."""
        expected, self.expects_error = self.expects_error, False
        errors = [*self.nodes.new_errors(), *self.silent.taken()]
        return [replace(error, meant=error.meant or expected) for error in errors]

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
        if prefixes.interfaces_of(package, prefixes.installed()):
            # Its compiled messages are imported from that package, which a folder of programs would hide.
            return self.package, ()
        executables = tuple(executable for name, _, executable in pairs if name == package)
        return (self.package if package == self.package.name else replace(self.package, name=package)), executables

    def _keep_earlier(self, name: str) -> None:
        """Keep the code of a node's earlier version, whose `main` the newer one runs with."""
        before = self.ran.get(name, "")
        if before and facts_of(before).is_complete:
            self.earlier[name] = before

    def _whole(self, name: str, code: str, after: Sequence[str]) -> str:
        pieces = []
        for used in after:
            piece = self.earlier.get(used) if used == name else self.parts.get(used, self.ran.get(used))
            if piece is None:
                raise CellFailed(f"This node uses what `{used}` defines: run its cell above first.")
            pieces.append(piece)
        try:
            complete = join(code, pieces)
            if complete.has_main_above:
                print("(runs with the `main` of the version above)")
            return complete.whole
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
        is_built = (self.workspace / "install" / self.package.name).is_dir()
        for name, (file, start) in self.starts.items():
            # What `colcon build` has installed is run by the real command.
            own = () if is_built else (f"{self.package.name}/{name}",)
            if f"{package}/{executable}" in (*start.known_as, *own):
                instance = self.instance(name if known_as == executable else known_as)
                self.run_background(instance, start.argv(file, words), self._import_path(file), Path.cwd(), bound)
                return True
        return False

    def run_background(
        self, name: str, argv: list[str], settings: dict[str, str], cwd: Path, bound: DisplayLimit
    ) -> None:
        """Start a process that continues in the background, and show its log for a while. Raises CellFailed."""
        if self.nodes.get(name):
            if self.nodes.status(name).running:
                is_newer = self.runs.get(name, "") != self.ran.get(name, "")
                print(f"(restarting {name}{' with its new version' if is_newer else ''})")
            self.nodes.stop(name)
        self.runs[name] = self.ran.get(name, "")
        node = self.nodes.start(name, argv, settings, cwd, expects_error=bound.expects_error)
        self._show(node, bound)

    def _show(self, node: RunningNode, bound: DisplayLimit) -> None:
        has_joined = joins(node.process, self.domain.number)
        try:
            rest_is, short = f": %log {node.name} shows them", whole_in(Path.cwd(), node.name)
            show_for(node.process, bound, rest_is, has_joined, short)
        except KeyboardInterrupt:
            print(f"\n{self.nodes.stop(node.name).in_words}")
            return
        status = node.process.status
        if status.exit is None:
            print(
                f"— {node.name} continues in the background: %stop {node.name} ends it, "
                f"%log {node.name} shows more\N{NO-BREAK SPACE}—"
            )
        elif status.exit == 0:
            print(f"— {node.name} has ended (exit code 0) —")
        elif not node.expects_error:
            error = node.errors()
            advice = f" {error.advice}" if error and error.advice else ""
            raise CellFailed(f"{node.name} {how_it_ended(status.exit)} Its last output is above.{advice}")

    def run_command(
        self,
        argv: list[str],
        settings: dict[str, str],
        cwd: Path,
        bound: DisplayLimit,
        shown_as: str,
        grace: tuple[float, float] = COMMAND_GRACE,
    ) -> Status:
        """Run a command in the cell, and end it as Ctrl-C would when its time is up. Raises CellFailed if it fails.

        Then it has `grace` to end by itself (see `KeptProcess.stop`). Return how it ended.
        """
        process = KeptProcess(argv, {**os.environ, **settings}, cwd)
        try:
            try:
                show_for(process, bound, "", joins(process, self.domain.number), whole_in(Path.cwd(), shown_as))
                bounded = process.status.running
            except KeyboardInterrupt:
                bounded = True
            if bounded:
                process.stop(grace)
                show_rest(process, sum(grace) + 1)
        finally:
            process.close()
        status = process.status
        if bounded and status.ended_by == "SIGKILL":
            print(f"— {shown_as} ignored Ctrl-C and was killed —")
        elif not bounded and status.exit != 0:
            if not bound.expects_error:
                raise CellFailed(f"{shown_as}: {how_it_ended(status.exit or 0)}")
            print(f"{AS_EXPECTED}{shown_as} {how_it_ended(status.exit or 0)} —")
        return status

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
        text = readable(data.decode(errors="replace"))
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
