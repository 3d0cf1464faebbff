"""The notebook's commands: `%%node`, `%nodes`, `%stop`, `%log`, `%ros2`, `%colcon`, `%plot`, `%robot` …

Each reads its line and calls the session.
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Sequence
from typing import Any

from IPython.core.magic import Magics, cell_magic, line_magic, magics_class, no_var_expand

from spinbook.course.course import Package
from spinbook.kernel import environment, interface_cell, picture_cells, terminal_cells, timeline_cell
from spinbook.kernel.cell_output import DisplayLimit
from spinbook.kernel.session import COMMAND_SECONDS, GRAPH_SECONDS, LOG_SECONDS, NodeStart, Session
from spinbook.package.cell_line import CellFailed, LineReader, chapter_reader, node_reader, split

_OWN_OPTION = re.compile(r"""\s*--(?:(seconds|until)\s+("[^"]*"|'[^']*'|\S+)|(expect-error)(?!\S))\s*""")


def own_options(line: str, seconds: float) -> tuple[DisplayLimit, str]:
    """Split leading options `--seconds N`, `--until TEXT`, `--expect-error` from a line whose rest belongs to another
    command. `seconds` is the default.
    """
    until, expects_error = None, False
    while match := _OWN_OPTION.match(line):
        option, value, flag = match.groups()
        line = line[match.end() :]
        expects_error = expects_error or bool(flag)
        if option == "until":
            until = shlex.split(value)[0]
        elif option:
            try:
                seconds = float(value)
            except ValueError:
                raise CellFailed("`--seconds` needs a number, as in --seconds 5.") from None
    return DisplayLimit(seconds, until, expects_error), line


@magics_class
class SpinbookMagics(Magics):
    """The commands of one notebook."""

    def __init__(self, shell: Any, session: Session) -> None:
        super().__init__(shell)
        self.session = session

    @no_var_expand
    @line_magic
    def chapter(self, line: str) -> None:
        """%chapter NAME --package PACKAGE: set the chapter and the package of this notebook's nodes."""
        if arguments := chapter_reader().read(line):
            self.session.package = Package(name=arguments.package, workspace=arguments.workspace)
            interface_cell.begin(self.session)

    @no_var_expand
    @cell_magic
    def interface(self, line: str, cell: str) -> None:
        """%%interface msg/NAME.msg: define a message, a service or an action, and compile it if it is new."""
        reader = LineReader("%%interface", "Define a message, a service or an action: this cell has its text.")
        reader.add_argument("path", help="msg/NAME.msg, srv/NAME.srv or action/NAME.action; a package may come first")
        if arguments := reader.read(line):
            interface_cell.run(self.session, arguments.path, cell.rstrip("\n") + "\n" if cell.strip() else "")

    @no_var_expand
    @cell_magic
    def package_file(self, line: str, cell: str) -> None:
        """%%package_file launch/NAME.launch.py: put this cell's text into the package as a file."""
        reader = LineReader("%%package_file", "Put a launch or parameter file into the package.")
        reader.add_argument("path", help="launch/NAME.launch.py (.yaml, .xml) or config/NAME.yaml")
        if arguments := reader.read(line):
            self.session.write_file(arguments.path, cell)

    @no_var_expand
    @cell_magic
    def node(self, line: str, cell: str) -> None:
        """%%node NAME: run this cell's code as a process of its own, as `ros2 run` would."""
        if arguments := node_reader().read(line):
            name = arguments.name.removesuffix(".py")
            if not name.isidentifier():
                raise CellFailed(f"`{name}` can't be a node's file name: use letters, digits and underscores.")
            parts = arguments.after if arguments.after or arguments.usual_imports else None
            start = NodeStart(tuple(arguments.classes), arguments.main, tuple(arguments.known_as))
            bound = DisplayLimit(arguments.seconds, arguments.until, arguments.expect_error)
            self.session.head = self._lines_above(cell)
            self.session.replace_node(arguments.replaces)
            if arguments.of:
                self.session.save_node(name, cell, start)
                print(f"— saved: `ros2 run` starts this program of the chapter {arguments.of} —")
            elif arguments.keep:
                self.session.keep_node(name, cell, start, parts)
            else:
                self.session.run_node(name, cell, bound, start, parts)

    def _lines_above(self, code: str) -> int:
        """Return how many lines the current cell has above this code: that of its magic, and empty ones."""
        typed = self.shell.history_manager.input_hist_raw[-1] if self.shell and self.shell.history_manager else ""
        above, same, _ = typed.partition(f"\n{code.rstrip()}")
        return above.count("\n") + 1 if same else 1

    @no_var_expand
    @cell_magic
    def part(self, line: str, cell: str) -> None:
        """%%part NAME: code that later nodes use, by `%%node … --after NAME`."""
        reader = LineReader("%%part", "Keep this cell's code for nodes further down, and run it as any other cell.")
        reader.add_argument("name", help="its name for `--after`")
        reader.add_argument("--keep", action="store_true", help="only keep it, because it can't run by itself")
        if arguments := reader.read(line):
            self.session.parts[arguments.name] = cell
            if arguments.keep:
                print(f"— kept for the nodes below that use it: {arguments.name} —")
            else:
                assert self.shell is not None
                self.shell.run_cell(cell).raise_error()

    @no_var_expand
    @line_magic
    def nodes(self, line: str) -> None:
        """%nodes: list the nodes that this notebook has started, and whether they still run."""
        reader = LineReader("%nodes", "List the nodes that this notebook has started.")
        if reader.read(line) is None:
            return
        names = self.session.nodes.names()
        for name in names:
            status = self.session.nodes.status(name)
            state = "running" if status.exit is None else f"ended (exit code {status.exit})"
            print(f"{name:<28} {state:<22} {status.lines} lines logged")
        if not names:
            print("No nodes. Run a cell that begins with %%node.")

    @no_var_expand
    @line_magic
    def stop(self, line: str) -> None:
        """%stop NAME … | --all: end nodes as Ctrl-C would."""
        reader = LineReader("%stop", "End nodes as Ctrl-C in their terminal would.")
        reader.add_argument("names", nargs="*")
        reader.add_argument("--all", action="store_true", help="every node of this notebook")
        arguments = reader.read(line)
        if arguments is None:
            return
        if not arguments.names and not arguments.all:
            running = ", ".join(self.session.nodes.names()) or "none"
            raise CellFailed(f"Which one? %stop NAME, or %stop --all. Started: {running}.")
        for stopped in self.session.stop(None if arguments.all else arguments.names):
            print(stopped.in_words)

    @no_var_expand
    @line_magic
    def log(self, line: str) -> None:
        """%log NAME [--all] [--until TEXT]: show what a node has printed so far."""
        reader = LineReader("%log", "Show what a node has printed since it was started.")
        reader.add_argument("name")
        reader.add_argument("--all", action="store_true", help="every line, however many")
        reader.add_argument("--until", help="wait until the log contains this text")
        reader.add_argument("--seconds", type=float, default=LOG_SECONDS, help="how long to wait for it at most")
        if arguments := reader.read(line):
            if arguments.until is not None:
                self.session.wait_for(arguments.name, DisplayLimit(arguments.seconds, arguments.until))
            print(self.session.log(arguments.name, arguments.all))

    @no_var_expand
    @line_magic
    def ros2(self, line: str) -> None:
        """%ros2 …: run the command of a terminal, with a time limit."""
        bound, rest = own_options(line, COMMAND_SECONDS)
        self.session.expects_error |= bound.expects_error
        terminal_cells.run_ros2(self.session, split(rest), bound)

    @no_var_expand
    @line_magic
    def colcon(self, line: str) -> None:
        """%colcon build …: run colcon in this notebook's workspace."""
        bound, rest = own_options(line, terminal_cells.COLCON_SECONDS)
        terminal_cells.run_colcon(self.session, split(rest), bound)

    @no_var_expand
    @line_magic
    def plot(self, line: str) -> None:
        """%plot TOPIC/FIELD[i] …: draw what topics carry, as rqt_plot would."""
        reader = LineReader("%plot", "Record topics for a while and draw them, live in an open notebook.")
        reader.add_argument("what", nargs="+", metavar="TOPIC/FIELD[i]", help="such as /turtle1/pose/x")
        reader.add_argument("--seconds", type=float, default=COMMAND_SECONDS, help="how long to record")
        reader.add_argument("--title", default="", help="the title above the plot")
        if arguments := reader.read(line):
            picture_cells.show_plot(arguments.what, arguments.seconds, arguments.title)

    @no_var_expand
    @line_magic
    def timeline(self, line: str) -> None:
        """%timeline --record NAME …, and later %timeline: draw what happened on services, actions and topics."""
        reader = LineReader("%timeline", "Record services, actions and topics while other cells run, then draw them.")
        reader.add_argument("--record", nargs="+", metavar="NAME", help="begin to record these")
        reader.add_argument("--title", default="", help="the title above the picture")
        arguments = reader.read(line)
        if arguments is None:
            return
        recorded, self.session.timeline = self.session.timeline, None
        if arguments.record:
            if recorded is not None:
                recorded.close()
            self.session.timeline = timeline_cell.begin(arguments.record)
        elif recorded is None:
            raise CellFailed("Nothing is being recorded. Begin with: %timeline --record /NAME")
        else:
            timeline_cell.show(recorded, arguments.title)

    @no_var_expand
    @line_magic
    def turtle(self, line: str) -> None:
        """%turtle: turtlesim's window as a picture: the turtle and its trail."""
        reader = LineReader("%turtle", "Show turtlesim's window as it is now.")
        if reader.read(line) is not None:
            picture_cells.show_turtle()

    @no_var_expand
    @line_magic
    def robot(self, line: str) -> None:
        """%robot [PACKAGE or FILE]: a robot as its URDF describes it, moved by the positions that are published."""
        reader = LineReader("%robot", "Show a robot, moved by /joint_states or /joint_commands.")
        reader.add_argument("source", nargs="?", default="", help="a URDF; without it, /robot_description is shown")
        reader.add_argument("--seconds", type=float, default=COMMAND_SECONDS, help="how long to record")
        if arguments := reader.read(line):
            # Imported here because few chapters have a robot.
            from spinbook.kernel import robot_cell

            robot_cell.show_robot(arguments.source, arguments.seconds)

    @no_var_expand
    @line_magic
    def graph(self, line: str) -> None:
        """%graph: nodes and topics as they are now, drawn as rqt_graph would."""
        reader = LineReader("%graph", "Draw who publishes and who subscribes, and how many messages per second arrive.")
        reader.add_argument("--seconds", type=float, default=GRAPH_SECONDS, help="how long messages are counted")
        if arguments := reader.read(line):
            picture_cells.show_graph(arguments.seconds)

    @no_var_expand
    @line_magic
    def check(self, line: str) -> None:
        """%check EXERCISE: run the public checks on the exercise's cell."""
        reader = LineReader("%check", "Check the cell of an exercise, as you last ran it. This is not your grade.")
        reader.add_argument("exercise")
        reader.add_argument("--course", default="", help="the folder of the handout, if it is not this one")
        reader.add_argument("--seconds", type=float, default=60.0, help="how long it may take")
        if arguments := reader.read(line):
            # Imported here because most cells are not exercises.
            from spinbook.kernel import check_cell

            check_cell.check_cell(self.session, self.shell, arguments.exercise, arguments.course, arguments.seconds)

    @no_var_expand
    @line_magic("try")  # type: ignore[arg-type]
    def try_out(self, line: str) -> None:
        """%try EXERCISE [SCENARIO]: run the exercise's node in real time, among what surrounds it, with a picture."""
        reader = LineReader("%try", "Run an exercise's node, as you last ran its cell, among what surrounds it.")
        reader.add_argument("exercise")
        reader.add_argument("scenario", nargs="?", default="", help="one of the exercise's scenarios, not the first")
        reader.add_argument("--course", default="", help="the folder of the handout, if it is not this one")
        if arguments := reader.read(line):
            from spinbook.kernel import try_cell

            try_cell.try_out(self.session, self.shell, arguments.exercise, arguments.scenario, arguments.course)

    @no_var_expand
    @line_magic
    def hint(self, line: str) -> None:
        """%hint EXERCISE: show the next hint for the first check that failed."""
        reader = LineReader("%hint", "Show where to look, and then what to do, for the first check that failed.")
        reader.add_argument("exercise")
        reader.add_argument("--course", default="", help="the folder of the handout, if it is not this one")
        if arguments := reader.read(line):
            from spinbook.kernel import check_cell

            check_cell.show_hint(self.shell, arguments.exercise, arguments.course)

    @no_var_expand
    @line_magic
    def submit(self, line: str) -> None:
        """%submit EXERCISE: write one file to upload, with the exercise's cell as it was last run."""
        reader = LineReader("%submit", "Write one file to upload: the exercise's cell, as you last ran it.")
        reader.add_argument("exercise")
        reader.add_argument("--student", help="your name or number, as your course requires; kept for the next time")
        reader.add_argument("--course", default="", help="the folder of the handout, if it is not this one")
        reader.add_argument("--seconds", type=float, default=120.0, help="how long it may take")
        if arguments := reader.read(line):
            from spinbook.kernel import check_cell

            check_cell.submit_cell(
                self.session, self.shell, arguments.exercise, arguments.course, arguments.student, arguments.seconds
            )

    @no_var_expand
    @line_magic
    def domain(self, line: str) -> None:
        """%domain [N]: show or set the ROS domain of this notebook's nodes."""
        reader = LineReader("%domain", "Show this notebook's ROS domain, or join another one.")
        reader.add_argument("number", nargs="?", type=int, help="communicate with everything in this domain")
        arguments = reader.read(line)
        if arguments is None:
            return
        if arguments.number is not None:
            try:
                chosen = environment.shared_domain(arguments.number)
            except ValueError as error:
                raise CellFailed(str(error)) from None
            self.session.stop(None)
            self.session.domain.release()
            self.session.use_domain(chosen)
        print(f"ROS_DOMAIN_ID={self.session.domain.number}", end="")
        print(" (this notebook's own)" if self.session.domain.lock is not None else " (shared)")


def register(shell: Any, session: Session) -> Sequence[str]:
    """Add the commands to a shell. Return their names."""
    magics = SpinbookMagics(shell, session)
    shell.register_magics(magics)
    return [*magics.magics["line"], *magics.magics["cell"]]
