"""Decides whether each command in a chapter's shell fences can run: are its program, package and types available?"""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from grader.recording.types import OWN_SERVICES
from groundwork.problem import Problem, Severity
from groundwork.words import did_you_mean, similar
from ros_in_python.ros2 import executables
from spinbook.chapter.chapter import ChapterCell
from spinbook.chapter.classify import CellKind, ClassifiedFence
from spinbook.chapter.foreign_commands import (
    READ_KEYS,
    TO_FILL_IN,
    Reason,
    foreign_program,
    has_launch_file,
    missing_type,
)
from spinbook.chapter.imports import IN_ROS, ros_packages
from spinbook.chapter.launch_files import NotSupportedError
from spinbook.chapter.launches import Launches, launch_words
from spinbook.chapter.own_packages import OwnPackages, create_options, new_package
from spinbook.chapter.program_names import ProgramNames
from spinbook.chapter.terminal import Command, CommandKind, is_placeholder, note
from spinbook.chapter.values_in_commands import wrong_values

#: Commands that fail if the name they are given does not exist: noun -> verbs.
_ASKING = {
    "topic": {"echo", "info", "type", "hz", "bw", "delay"},
    "service": {"call", "type", "info"},
    "node": {"info"},
    "action": {"info", "send_goal"},
    "lifecycle": {"get", "set", "list"},
    "param": {"list", "get", "set", "describe", "dump", "load", "delete"},
}


#: What stands for a name: `/topic_name`, `/your_node`.
_NAME_PLACEHOLDER = re.compile(r"/?(your_\w+|(the_|a_)?(topic|node|service|action|param(eter)?)(_?name)?)")


class _CodeSoFar:
    """The text of all code above: a name that a program creates is somewhere in it."""

    def __init__(self) -> None:
        self._text = ""

    def add(self, text: str) -> None:
        """Add code that runs, with the names that turtlesim and the demo nodes create."""
        self._text += text.lower()
        self._text += "".join(names for package, names in _GIVEN.items() if package in text)

    def __contains__(self, name: str) -> bool:
        return name in self._text


_TURTLESIM = " turtlesim turtle1 turtle2 cmd_vel pose color_sensor spawn kill clear reset set_pen teleport_absolute "
_TURTLESIM += "teleport_relative rotate_absolute background_r background_g background_b "
#: Package -> the names that its programs create.
_GIVEN = {"turtlesim": _TURTLESIM, "demo_nodes_": " chatter talker listener add_two_ints "}


@dataclass
class Shells:
    """The shell fences of one chapter.

    `package` is the course's own, `modules` are those that the course's node cells make, `own` the chapter's packages,
    `named_files` the file that the text before a fence names, `interfaces` the course's own.
    """

    file: Path
    package: str
    modules: frozenset[str]
    own: OwnPackages
    named_files: Mapping[int, str]
    has_exercise: bool
    interfaces: frozenset[str]
    earlier_programs: Callable[[str, str], ChapterCell | None]
    borrowed: dict[int, list[ChapterCell]] = field(default_factory=dict)
    """The programs of earlier chapters that commands run, by the line of the fence."""
    problems: list[Problem] = field(default_factory=list)
    _created: set[str] = field(default_factory=set)
    _hello: set[tuple[str, str]] = field(default_factory=set)
    """The programs that `ros2 pkg create --node-name` makes: (package, executable)."""
    _line: int = 0
    """Where the fence begins that is decided now."""
    _launches: Launches = field(init=False)
    _said: _CodeSoFar = field(default_factory=_CodeSoFar)
    _nodes: dict[str, int] = field(default_factory=dict)
    """The chapter's nodes so far -> their number among the fences."""
    _by_file: set[int] = field(default_factory=set)
    """Those of them that a command starts by the name of their file."""

    def __post_init__(self) -> None:
        self._launches = Launches(self.package, self.named_files)

    def decide(self, items: Sequence[ClassifiedFence]) -> list[ClassifiedFence]:
        """Decide what each fence becomes; a node that `ros2 run` starts below also gets the names used there."""
        out = list(items)
        for number, item in enumerate(items):
            if item.kind is CellKind.NODE and item.name:
                self._nodes[item.name] = number
            elif item.kind is CellKind.SHELL:
                out[number] = self._fence(item, out)
            elif item.kind is CellKind.INTERFACE:
                self._created.add((item.name or "").partition("/")[0])
            elif not item.is_static:
                self._said.add(item.whole)
            self._launches.add(number, item)
            if item.kind is CellKind.NODE:
                self._said.add(item.whole)
        return out

    def _fence(self, item: ClassifiedFence, out: list[ClassifiedFence]) -> ClassifiedFence:
        self._line = item.fence.line
        commands = [self._compiled_here(command) for command in item.commands]
        launches = {command.line: command.text for command in commands if command.words[1:2] == ("launch",)}
        built = self._launches.are_built
        item = replace(item, commands=tuple(part for command in commands for part in self._launches.started(command)))
        if all(command.kind is CommandKind.NOTE for command in item.commands):
            return replace(item, kind=CellKind.STATIC, why="it makes a package of interfaces, which is compiled here")
        if len(item.commands) > 1:
            item = self._without_keys(item)
        for command in item.commands:
            line = item.fence.first_code_line + command.line - 1
            reason = self._refused(command, out, line)
            if reason and command.runs and command.line in launches:
                reason = _of_launch_file(reason, *command.runs)
            if reason is None:
                self._said.add(command.text if "pub" in command.words or "run" in command.words else "")
                continue
            problem = f"{reason.why} (`{launches.get(command.line, command.text)}`)."
            self.problems.append(Problem(self.file, line, problem, reason.fix, Severity.NOT_RUN, group=reason.group))
            self.borrowed.pop(self._line, None)
            self._launches.are_built = built
            return replace(item, kind=CellKind.STATIC, why=reason.why, sign=f"{reason.why}.")
        return item

    def _without_keys(self, item: ClassifiedFence) -> ClassifiedFence:
        """Make comments of programs that read keys, so that the other commands of their fence run."""
        commands = tuple(
            note(f"{command.text} (reads keys: run it in a terminal)", command.line)
            if command.runs in READ_KEYS
            else command
            for command in item.commands
        )
        is_left = any(command.kind is not CommandKind.NOTE for command in commands)
        return replace(item, commands=commands) if is_left else item

    def _refused(self, command: Command, out: list[ClassifiedFence], line: int) -> Reason | None:
        if command.kind is CommandKind.COLCON:
            return self._colcon(command, out)
        if command.kind is not CommandKind.ROS2:
            return None
        if self._lacks_file(command):
            fix = "Give the parameters with -p NAME:=VALUE."
            return Reason("it reads a parameter file, which is missing", fix, "files of parameters")
        if command.runs is not None:
            return self._run(command, out, line) or self._lacks_words(command, out)
        if command.words[1:2] == ("launch",):
            is_ours = self._launches.is_of_package(command)
            return self._whole_launch(command, out, line) if is_ours else self._launch(command)
        if command.words[1:3] == ("pkg", "create"):
            return self._create(command)
        self._check_values(command, line)
        return missing_type(command, self.interfaces) or self._named(command)

    def _run(self, command: Command, out: list[ClassifiedFence], line: int) -> Reason | None:
        package, executable = command.runs or ("", "")
        if package == self.package and executable in self._nodes:
            self._by_file.add(self._nodes[executable])
            if out[self._nodes[executable]].executables:
                self._start(self._nodes[executable], command, out)
            return None
        if not self._is_elsewhere(package):
            names = ProgramNames({number: out[number] for number in self._nodes.values()}, self.own)
            number = names.started(package, executable)
            if number is None and self._borrow(package, executable):
                return None
            if number is None and (number := names.similar(package, executable)) is not None:
                self._say_which(package, executable, out[number].name or "", line)
            if number is not None:
                self._check_package(package, line)
                self._start(number, command, out)
                return None
            if (package, executable) in self._hello:
                return None
            if reason := self._shown_only(package, executable, out):
                return reason
            if package in self.own.names and (close := names.close(executable)):
                fix = f"Did you mean `{close}`? Otherwise show its program in a fence above."
                why = f"no fence above shows `{executable}` of `{package}`"
                return Reason(why, fix, "programs that no fence shows")
        if package == self.package and executable in self.modules:
            return None
        if package == self.package:
            problem = f"the course's package `{package}` has no executable `{executable}`"
            meant = did_you_mean(executable, self.modules, "", "`{}`", 0.7)
            fix = f"{meant} Its node cells make these: {', '.join(sorted(self.modules)) or 'none'}."
            return Reason(problem, fix.lstrip(), "")
        return foreign_program(package, executable, self.package, self.own.names)

    def _shown_only(self, package: str, executable: str, out: Sequence[ClassifiedFence]) -> Reason | None:
        """Return a reason if a fence above shows the program, and is not run itself."""
        shown = {
            number: replace(item, name=_file_name(title).removesuffix(".py"))
            for number, item in enumerate(out)
            if item.is_static and item.code and item.fence.line < self._line
            if (title := item.fence.title or self.named_files.get(item.fence.line, "")) or item.code.node_classes
        }
        number = ProgramNames(shown, self.own).started(package, executable)
        if number is None:
            return None
        why = f"the program in line {out[number].fence.line} is not run itself: {out[number].why}"
        return Reason(why, "Once that program runs, the command does, too.", "")

    def _borrow(self, package: str, executable: str) -> bool:
        """Let a command run a program that an earlier chapter shows. Return whether there is one."""
        cell = self.earlier_programs(package, executable)
        if cell is None:
            return False
        known = tuple(dict.fromkeys([*cell.executables, (package, executable)]))
        if not any(other.name == cell.name for other in itertools.chain(*self.borrowed.values())):
            self.borrowed.setdefault(self._line, []).append(replace(cell, executables=known))
        self._said.add(cell.whole)
        return True

    def _start(self, number: int, command: Command, out: list[ClassifiedFence]) -> None:
        """Give a node the name by which a command starts it. One that counts its arguments waits for a command's."""
        item = out[number]
        own = [(self.package, item.name or "")] if number in self._by_file else []
        known = dict.fromkeys([*own, *item.executables, command.runs or ("", "")])
        waits = item.waits or bool(item.code and item.code.counts_words and _arguments(command))
        out[number] = replace(item, executables=tuple(known), waits=waits)

    def _say_which(self, package: str, executable: str, node: str, line: int) -> None:
        problem = f"no fence above says which program `{executable}` of `{package}` is: `{node}` is started."
        fix = f"Did you mean `{node}`? Otherwise show the program, or the line of setup.py that names it."
        self.problems.append(Problem(self.file, line, problem, fix, Severity.WARNING, group="the name of a program"))

    def _check_package(self, package: str, line: int) -> None:
        """Report a package whose name is nearly the course's own."""
        if package != self.package and package not in self.own.names and similar(package, [self.package], 0.85):
            problem = f"the course's package is `{self.package}`, not `{package}`."
            self.problems.append(Problem(self.file, line, problem, f"Did you mean `{self.package}`?", Severity.WARNING))

    def _is_elsewhere(self, package: str) -> bool:
        """Return whether a package is part of ROS or Spinbook, so that it is not a program of the chapter."""
        comes_with_us = package in executables.BUILT_IN and package not in self.own.names
        defined_here = any(name.startswith(f"{package}/") for name in self.interfaces)
        return comes_with_us or (package in ros_packages() and not defined_here)

    def _lacks_words(self, command: Command, out: Sequence[ClassifiedFence]) -> Reason | None:
        """Return a reason if a program of the chapter reads more arguments than the command gives it."""
        arguments = _arguments(command)
        for number in self._nodes.values():
            code = out[number].code
            if command.runs in out[number].executables and code and code.words_read > len(arguments):
                words = "an argument" if code.words_read == 1 else f"{code.words_read} arguments"
                why = f"`{command.words[3]}` reads {words} from its command line"
                return Reason(why, "Add them to the command, as a reader would.", "")
        return None

    def _whole_launch(self, command: Command, out: list[ClassifiedFence], line: int) -> Reason | None:
        """Return a reason if a launch file of the package can't run: it is not built, or lacks a program."""
        if not self._launches.are_built:
            why = f"no cell above has put `{launch_words(command)[-1]}` into `{self.package}` with `colcon build`"
            return Reason(why, "Put a shell fence with `colcon build` above it.", "")
        for node in self._launches.named_nodes(command):
            started = node.command(command.line)
            if reason := self._run(started, out, line):
                return _of_launch_file(reason, node.package, node.executable)
            self._said.add(started.text)
        return None

    def _launch(self, command: Command) -> Reason | None:
        names = launch_words(command)
        try:
            self._launches.nodes(command)
        except NotSupportedError as error:
            fix = "It starts nothing here, because a part of it would be missing. Start its nodes with `ros2 run`."
            if not str(error).startswith("line") and (file := self._launches.could_run_whole(command)):
                fix = f'To run all of it, write title="launch/{file}", and ros2 launch {self.package} {file}'
            return Reason(f"its launch file can't run here: {error}", fix, "")
        package = names[0] if len(names) > 1 else ""
        if package and has_launch_file(package, names[1]):
            return None
        if not package or package in {self.package, *self.own.names, *ros_packages()}:
            file = _file_name(names[-1]) if names else ""
            if file in self._launches.files:
                why = f"`{file}` becomes a file of the course's package, `{self.package}`, and not of `{package}`"
                return Reason(why, f"Write: ros2 launch {self.package} {file}", "")
            if file in self._launches.titles:
                fix = f'Write title="launch/{file}", and ros2 launch {self.package} {file}'
                return Reason(f"`{file}` is shown above with a title that makes no file of it", fix, "")
            close = self._launches.close(file)
            fix = f"Did you mean `{close}`?" if close else "Show it in a fence above."
            return Reason("no fence above is its launch file", fix, "" if close else "launch files")
        if is_placeholder(package):
            return TO_FILL_IN
        fix = f"Show its launch file and its programs in fences of the chapter, or {IN_ROS}."
        return Reason(f"there is no package `{package}` here", fix, package)

    def _lacks_file(self, command: Command) -> bool:
        """Return whether a command reads a parameter file that no cell above has put into the package."""
        words = command.words
        named = [after for word, after in itertools.pairwise(words) if word == "--params-file"]
        if words[1:3] == ("param", "load"):
            named += [word for word in words[4:] if not word.startswith("-")]
        return any(_file_name(word) not in self._launches.files for word in named)

    def _compiled_here(self, command: Command) -> Command:
        """Return a comment in place of a command that makes or builds packages whose interfaces the chapters define."""
        packages = {name.partition("/")[0] for name in self.interfaces}
        makes = command.words[1:3] == ("pkg", "create") and new_package(command.words).name in packages
        chosen = _selected(command.words) if command.kind is CommandKind.COLCON else []
        if makes or (chosen and packages.issuperset(chosen)):
            return note(command.text, command.line)
        return command

    def _create(self, command: Command) -> Reason | None:
        package = new_package(command.words)
        name = package.name
        if package.unknown:
            known = create_options()
            unknown = package.unknown[0].partition("=")[0]
            fix = did_you_mean(unknown, known, f"Its options: {', '.join(known)}.", "`{}`")
            return Reason(f"`ros2 pkg create` has no option `{unknown}`", fix, "")
        if package.build_type != "ament_python":
            fix = "Python packages have --build-type ament_python."
            return Reason("it makes a package for C++", fix, "C++ packages")
        if name and is_placeholder(name):
            return TO_FILL_IN
        if not re.fullmatch(r"[a-z][a-z0-9_]*", name):
            return Reason("it does not name a package", "Write: ros2 pkg create --build-type ament_python NAME", "")
        self._created.add(name)
        self._hello.add((name, package.node))
        return None

    def _colcon(self, command: Command, out: Sequence[ClassifiedFence]) -> Reason | None:
        words = command.words
        makes = bool(self._nodes) or self.has_exercise
        there = self._created | ({self.package} if makes else set())
        there |= {package for package, _ in self.own.executables} & self.own.names if self._nodes else set()
        if words[1:2] == ("build",):
            # `ros2 run` has told which package a node above belongs to.
            there |= {package for number in self._nodes.values() for package, _ in out[number].executables}
        chosen = _selected(words)
        unknown = [name for name in chosen if name not in there]
        if not there or (chosen and unknown and not (self._nodes and set(chosen) & self.own.names)):
            what = f"`{unknown[0]}`" if unknown else "anything"
            fix = "Node cells above it make what it builds."
            return Reason(f"no cell above makes {what} to build", fix, "packages that no fence shows")
        return None

    def _named(self, command: Command) -> Reason | None:
        """Return a reason if a command names a topic, service or node that no program above contains."""
        words = [word for word in command.words[3:] if not word.startswith("-")]
        if command.words[1] not in _ASKING or command.words[2] not in _ASKING[command.words[1]] or self.has_exercise:
            return None
        name = _last_name(words[0]) if words else ""
        if command.words[1] == "lifecycle" and "lifecyclenode" not in self._said:
            return Reason("nothing above makes a node with a life cycle", "Show it in a fence above.", "")
        typed = command.words[1:3] == ("topic", "echo") and len(words) > 1
        if not name or typed or name in {"rosout", "parameter_events"} or name in self._said:
            return None
        if _NAME_PLACEHOLDER.fullmatch(words[0]):
            return TO_FILL_IN
        fix = "Show what makes it in a fence above."
        return Reason(f"nothing above makes `{words[0]}`", fix, "names that nothing makes")

    def _check_values(self, command: Command, line: int) -> None:
        """Report fields that the type of a message, request or goal on a command line does not have."""
        for wrong in wrong_values(command):
            problem = f"{wrong.problem[:-1]} (`{command.text}`)."
            self.problems.append(Problem(self.file, line, problem, wrong.fix, Severity.WARNING))


def _of_launch_file(reason: Reason, package: str, executable: str) -> Reason:
    """Return a reason with the program that a launch file starts, which its command does not name."""
    return replace(reason, why=f"its launch file starts `{executable}` of `{package}`, but {reason.why}")


def _arguments(command: Command) -> list[str]:
    """Return the words that `ros2 run` hands on to a program, without those for ROS."""
    return list(itertools.takewhile(lambda word: not word.startswith("-"), command.words[4:]))


def _last_name(path: str) -> str:
    """Return the part of a name that a program contains: the last one, or the node's for its parameter services."""
    node, _, last = path.strip("/").lower().rpartition("/")
    return _last_name(node) if last in OWN_SERVICES and node else last


def _file_name(path: str) -> str:
    return path.rpartition("/")[2]


def _selected(words: Sequence[str]) -> list[str]:
    chosen: list[str] = []
    taking = False
    for word in words:
        if word.startswith("--"):
            taking = word in {"--packages-select", "--packages-up-to"}
        elif taking:
            chosen.append(word)
    return chosen
