"""A chapter as data: what it is called, and its cells in order."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from enum import Enum
from pathlib import Path

from spinbook.chapter.terminal import Command


class CellKind(str, Enum):
    """What a cell is, which decides what it becomes in each product."""

    PROSE = "prose"
    NODE = "node"
    SNIPPET = "snippet"
    PART = "part"
    SHELL = "shell"
    INTERFACE = "interface"
    FILE = "package_file"
    EXERCISE = "exercise"


@dataclass(frozen=True)
class Cell:
    """One cell of a chapter. `line` is the chapter's line on which its source begins, counted from 1.

    `name` is a node's name (its file without .py), an exercise's, or an interface's, such as
    `my_interfaces/msg/Pose.msg`. `seconds` bounds how long it shows or runs
    (None: the runtime's default), `until` is a text in its log that ends that time early. `raises` says that failing
    is the lesson. `spin_classes` are the classes to spin where a node's code only defines them, `runs_main` says that
    its `main` has to be called. `before` is the code above a node's that makes it whole, taken from the nodes and parts
    that `after` names; a part is code that later nodes use, and with `runs_in_kernel` a snippet as well. `executables`
    are what `ros2 run` calls a node: (package, executable).
    """

    kind: CellKind
    id: str
    source: str
    line: int
    name: str | None = None
    seconds: float | None = None
    until: str | None = None
    raises: bool = False
    spin_classes: tuple[str, ...] = ()
    runs_main: bool = False
    before: str = ""
    after: tuple[str, ...] = ()
    runs_in_kernel: bool = True
    executables: tuple[tuple[str, str], ...] = ()
    commands: tuple[Command, ...] = ()

    @property
    def module(self) -> str:
        """The file name of a node's code."""
        return f"{self.name}.py"

    @property
    def whole(self) -> str:
        """A node's program as it runs."""
        return self.before + self.source


@dataclass(frozen=True)
class StaticFence:
    """A fence that is shown and not run, with the reason, for `spinbook lint` to tell."""

    line: int
    language: str
    why: str
    sign: str = ""
    """What readers are told below it; "" where nothing needs to be said."""


@dataclass(frozen=True)
class Chapter:
    """A chapter that was read. `file` is as course.toml names it, relative to the course."""

    name: str
    file: Path
    title: str
    summary: str
    cells: tuple[Cell, ...]
    static_fences: tuple[StaticFence, ...] = ()
    uses: tuple[Path, ...] = ()
    """The files of the course that it includes or shows, relative to the course."""

    @property
    def interfaces(self) -> Iterator[Cell]:
        """The cells that define messages, services and actions, in order."""
        return (cell for cell in self.cells if cell.kind is CellKind.INTERFACE)

    @property
    def files(self) -> Iterator[Cell]:
        """The launch and parameter files of the package, in order."""
        return (cell for cell in self.cells if cell.kind is CellKind.FILE)

    @property
    def nodes(self) -> Iterator[Cell]:
        """The cells that are nodes, in order."""
        return (cell for cell in self.cells if cell.kind is CellKind.NODE)
