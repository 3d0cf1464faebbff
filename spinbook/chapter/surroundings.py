"""What a chapter may refer to outside itself."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from groundwork.problem import Problem
from spinbook.chapter.chapter import ChapterCell
from spinbook.chapter.labels import Label

#: (chapter, package, executable) -> the cell of an earlier chapter that shows this program; None if there is none.
EarlierPrograms = Callable[[Path, str, str], ChapterCell | None]


def no_earlier_program(chapter: Path, package: str, executable: str) -> ChapterCell | None:
    """Return None: for a chapter that is read by itself."""
    return None


@dataclass(frozen=True)
class Surroundings:
    """What a chapter may refer to outside itself.

    `package` is the course's ROS package, `modules` the node modules of the course's other chapters, `exercises` the
    exercises that exist, `names` the chapters' names, by their file, `interfaces` the messages, services and actions
    that the course defines, such as `my_robot_interfaces/msg/JointLimits`, with their definitions, `labels` what MyST's
    labels name, `titles` the chapters' titles, by their file, `not_compiled` why definitions in chapters are only
    shown, by the file and line on which each begins.
    """

    package: str
    modules: frozenset[str] = frozenset()
    exercises: frozenset[str] = frozenset()
    names: Mapping[Path, str] = field(default_factory=dict)
    interfaces: Mapping[str, str] = field(default_factory=dict)
    labels: Mapping[str, Label] = field(default_factory=dict)
    titles: Mapping[Path, str] = field(default_factory=dict)
    not_compiled: Mapping[tuple[Path, int], Problem] = field(default_factory=dict)
    earlier_programs: EarlierPrograms = no_earlier_program
    """Finds the program that an earlier chapter shows under the names of `ros2 run`."""
