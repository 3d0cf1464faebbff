"""Says of every fence what it is: a node, a snippet, shell, or static, with the reason where it is not run."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum
from pathlib import Path

from spinbook.chapter.definition_title import interface_path, is_someone_elses
from spinbook.chapter.fence import ATTRIBUTES, Fence
from spinbook.chapter.python_code import CodeError, PythonCode, has_magics, inspect
from spinbook.chapter.terminal import Command, CommandKind, NotRunnable, read_commands
from spinbook.problem import Problem, Severity


class FenceKind(str, Enum):
    """What a fence is."""

    NODE = "node"
    SNIPPET = "snippet"
    SHELL = "shell"
    INTERFACE = "interface"
    STATIC = "static"


@dataclass(frozen=True)
class Classified:
    """A fence and what it is. `why` says why a static one is not run; `name` is a node's or an interface's."""

    fence: Fence
    kind: FenceKind
    why: str = ""
    name: str | None = None
    code: PythonCode | None = None
    commands: tuple[Command, ...] = ()

    @property
    def spin_class(self) -> str | None:
        """The class that the runtime must spin, where the code defines a Node and never spins it."""
        if self.kind is FenceKind.NODE and self.code and not self.code.spins and not self.code.has_main_guard:
            return self.code.node_classes[-1] if self.code.node_classes else None
        return None


def classify(
    fence: Fence, defined: Iterable[str], file: Path, interface_package: str = ""
) -> tuple[Classified, list[Problem]]:
    """Say what a fence is.

    `defined` are the names that earlier snippets of the chapter left in the kernel; `file` is what problems name.
    `interface_package` is the package of an interface whose title does not name one.
    """
    problems = _unknown_attributes(fence, file)
    if fence.has("static"):
        return Classified(fence, FenceKind.STATIC, "it says `static`"), problems
    if interface := interface_path(fence.title or "", interface_package):
        package = interface.partition("/")[0]
        if is_someone_elses(package, interface_package):
            why = f"it shows an interface of {package}, which is installed"
            return Classified(fence, FenceKind.STATIC, why), problems
        return Classified(fence, FenceKind.INTERFACE, name=interface), problems
    if fence.is_shell:
        return _shell(fence, file, problems)
    if fence.is_python:
        return _python(fence, frozenset(defined), file, problems)
    what = f"`{fence.language}` is" if fence.language else "a fence without a language is"
    return Classified(fence, FenceKind.STATIC, f"{what} neither Python nor shell"), problems


def _unknown_attributes(fence: Fence, file: Path) -> list[Problem]:
    unknown = [a for a in fence.attributes if a not in ATTRIBUTES]
    if not unknown or not (fence.is_python or fence.is_shell):
        return []
    known = "; ".join(f"`{name}`: {meaning}" for name, meaning in ATTRIBUTES.items())
    found = f"unknown attribute {', '.join(f'`{a}`' for a in unknown)} on this fence."
    return [Problem(file, fence.line, found, f"Known are {known}.", Severity.WARNING)]


def _shell(fence: Fence, file: Path, problems: list[Problem]) -> tuple[Classified, list[Problem]]:
    read = read_commands(fence.code)
    refused = [command for command in read if isinstance(command, NotRunnable)]
    commands = tuple(command for command in read if isinstance(command, Command))
    runnable = [command for command in commands if command.kind is not CommandKind.NOTE]
    if not runnable:
        why = refused[0].why if refused else "it holds no command that a notebook runs"
        if refused and refused[0].text.startswith(("ros2 ", "colcon ", "rqt_plot ")):
            problems.append(_not_run(fence, refused[0], file))
        return Classified(fence, FenceKind.STATIC, why), problems
    if refused:
        problems.append(_not_run(fence, refused[0], file))
        return Classified(fence, FenceKind.STATIC, refused[0].why), problems
    return Classified(fence, FenceKind.SHELL, commands=commands), problems


def _not_run(fence: Fence, command: NotRunnable, file: Path) -> Problem:
    line = fence.first_code_line + command.line - 1
    found = f"this shell fence is shown and not run: {command.why} (`{command.text}`)."
    mend = "Put what can run into a fence of its own, or write `static` behind the language to say that this is meant."
    return Problem(file, line, found, mend, Severity.WARNING)


def _python(
    fence: Fence, defined: frozenset[str], file: Path, problems: list[Problem]
) -> tuple[Classified, list[Problem]]:
    try:
        code = inspect(fence.code)
    except CodeError as error:
        line = fence.first_code_line + error.line - 1
        mend = "Mend the code, or write `static` behind the language if it is only to be shown and not run."
        problems.append(Problem(file, line, f"not Python: {error.message} (column {error.column}).", mend))
        return Classified(fence, FenceKind.STATIC, "it is not Python"), problems
    if why := _why_static(fence, code):
        return Classified(fence, FenceKind.STATIC, why, code=code), problems
    if fence.title or code.is_node:
        name, name_problems = _node_name(fence, code, file)
        problems.extend(name_problems)
        if has_magics(fence.code):
            found = "a node's code holds a notebook command (a line that begins with % or !)."
            mend = "A node is a file of its own, which Python runs: put the command into another fence."
            problems.append(Problem(file, fence.line, found, mend))
        return Classified(fence, FenceKind.NODE, name=name, code=code), problems
    missing = {name: line for name, line in code.needs.items() if name not in defined}
    if missing:
        names = ", ".join(f"`{name}`" for name in missing)
        why = f"it uses {names}, which no earlier snippet of the chapter defines"
        return Classified(fence, FenceKind.STATIC, why, code=code), problems
    return Classified(fence, FenceKind.SNIPPET, code=code), problems


def _why_static(fence: Fence, code: PythonCode) -> str:
    if not fence.code.strip():
        return "it is empty"
    if code.fragment:
        return f"it is a fragment: {code.fragment}"
    if code.is_setup_script:
        return "it is a setup.py"
    if code.is_launch_file:
        return "it is a launch file"
    if fence.title and not fence.title.endswith(".py"):
        return f"`{fence.title}` is no Python file"
    return ""


def _node_name(fence: Fence, code: PythonCode, file: Path) -> tuple[str, list[Problem]]:
    if fence.title:
        stem = fence.title.rsplit("/", 1)[-1].removesuffix(".py")
        if stem.isidentifier():
            return stem, []
        found = f"`{fence.title}` can't be a module: `{stem}` is no Python name."
        return stem, [
            Problem(file, fence.line, found, "Use letters, digits and underscores, such as joint_publisher.py.")
        ]
    name = code.ros_name or re.sub(r"(?<!^)(?=[A-Z])", "_", code.node_classes[0]).lower() if code.node_classes else None
    name = name or code.ros_name or "node"
    found = f"this fence is a node without a file name; it is called `{name}`."
    mend = f'Name its file: ```python title="{name}.py"'
    return name, [Problem(file, fence.line, found, mend, Severity.WARNING)]
