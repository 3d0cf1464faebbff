"""What `ros2 launch` starts in a chapter: a launch file that a cell has written, or the nodes of one that is shown."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field

from groundwork.words import similar
from spinbook.chapter.classify import CellKind, ClassifiedFence
from spinbook.chapter.launch_files import (
    LaunchedNode,
    NotSupportedError,
    launched_nodes,
    named_nodes,
    unsupported_in_launch_file,
)
from spinbook.chapter.terminal import Command, CommandKind, note


@dataclass
class Launches:
    """The launch and parameter files of a chapter so far.

    `package` is the course's, `named_files` the file that the text before a fence names, by the fence's line. `files`
    are those that cells above have put into the package, by name.
    """

    package: str
    named_files: Mapping[int, str]
    files: set[str] = field(default_factory=set)
    titles: set[str] = field(default_factory=set)
    """Those of fences that are only shown."""
    are_built: bool = False
    """Whether `colcon build` has installed the package since."""
    _codes: dict[str, str] = field(default_factory=dict)

    def add(self, number: int, item: ClassifiedFence) -> None:
        """Remember a fence that is a launch or parameter file; `number` is its place among the fences."""
        if item.kind is CellKind.FILE:
            self.files.add((item.name or "").rpartition("/")[2])
        elif item.is_static and (item.fence.title or "").endswith((".xml", ".yaml", ".yml", ".py")):
            self.titles.add((item.fence.title or "").rpartition("/")[2])
        if _is_launch_file(item):
            name = item.fence.title or self.named_files.get(item.fence.line) or f"launch file {number}"
            self._codes[name.rsplit("/", 1)[-1]] = item.fence.code

    def started(self, command: Command) -> list[Command]:
        """Replace `ros2 launch` of a launch file above by a comment and the commands that start all its nodes."""
        self.are_built |= command.words[:2] == ("colcon", "build")
        if command.kind is not CommandKind.ROS2 or command.words[1:2] != ("launch",):
            return [command]
        if self.is_of_package(command) and self.are_built:
            return [command]
        try:
            nodes = self.nodes(command)
        except NotSupportedError:
            return [command]
        started = [node.command(command.line) for node in nodes]
        return [note(f"{command.text} starts:", command.line), *started] if nodes else [command]

    def is_of_package(self, command: Command) -> bool:
        """Return whether a cell above has put the launch file into the course's package."""
        names = launch_words(command)
        is_ours = len(names) < 2 or names[0] == self.package
        return is_ours and any(name.rpartition("/")[2] in self.files for name in names)

    def nodes(self, command: Command) -> list[LaunchedNode]:
        """Return the nodes of the launch file above that a command names; none if there is no such file.

        Raises NotSupportedError if the file can't be run as a whole.
        """
        _, code = self._meant(command)
        pairs = [word.partition(":=") for word in command.words]
        return launched_nodes(code, {name: value for name, mark, value in pairs if mark}) if code else []

    def named_nodes(self, command: Command) -> list[LaunchedNode]:
        """Return the nodes of the launch file above that a command names, as far as it surely starts them."""
        files = [word.rpartition("/")[2] for word in launch_words(command)]
        return [node for file in files for node in named_nodes(self._codes.get(file, ""))]

    def could_run_whole(self, command: Command) -> str:
        """Return the launch file that would run as a whole if its title made a file of it; "" if it would not.

        Its programs must be those of the course's package.
        """
        file, code = self._meant(command)
        is_ours = set(re.findall(r"package=[\"'](\w+)", code)) == {self.package}
        return file if is_ours and not unsupported_in_launch_file(code) else ""

    def _meant(self, command: Command) -> tuple[str, str]:
        """Return the name and the code of the Python launch file that a command names; no code if none is above."""
        file = next((word.rpartition("/")[2] for word in launch_words(command) if word.endswith(".py")), "")
        unnamed = [name for name in self._codes if name.startswith("launch file ")]
        return file, self._codes.get(file) or (self._codes[unnamed[-1]] if file and len(unnamed) == 1 else "")

    def close(self, file: str) -> str:
        """Return the file whose name is most like this one; "" if none is."""
        return similar(file, [*self.files, *self._codes])


def launch_words(command: Command) -> list[str]:
    """Return the package and the file of `ros2 launch`, without options and arguments."""
    return [word for word in command.words[2:] if not word.startswith("-") and ":=" not in word]


def _is_launch_file(item: ClassifiedFence) -> bool:
    is_file = item.kind is CellKind.FILE and (item.name or "").startswith("launch/")
    return is_file or (item.code is not None and "def generate_launch_description" in item.fence.code)
