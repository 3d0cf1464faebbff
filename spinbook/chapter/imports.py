"""Whether what a chapter imports or runs is there: packages, ROS interfaces, executables."""

from __future__ import annotations

import difflib
import functools
import importlib.util
import re
import sys
from collections.abc import Iterable
from pathlib import Path

from interface_compiler import shipped
from spinbook.chapter.classify import Classified
from spinbook.chapter.terminal import CommandKind
from spinbook.problem import Problem
from spinbook.ros2 import interface_files, prefixes


def missing_imports(
    item: Classified, own_modules: frozenset[str], file: Path, own_interfaces: Iterable[str] = ()
) -> list[Problem]:
    """What a fence's Python imports and this environment does not have.

    `own_modules` are the course's: its package, and the modules that its node cells make; `own_interfaces` those
    that it defines, such as `my_interfaces/msg/Pose`.
    """
    code = item.code
    if code is None:
        return []
    problems = []
    for module, line in code.imports.items():
        top = module.partition(".")[0]
        if top not in own_modules and not _is_installed(top):
            found = f"imports `{top}`, which is not installed here."
            mend = (
                f"{_similar(top, own_modules)}Install it and add it to the course's dependencies, "
                "or write `static` behind the fence's language."
            )
            if top in (*shipped.standard(), *shipped.optional()):
                mend = f"Compile it, once: spinbook interfaces add {top}"
            problems.append(Problem(file, item.fence.first_code_line + line - 1, found, mend))
    for (module, name), line in code.interfaces.items():
        known = _own_names(module, own_interfaces) or interfaces_of(module)
        if known and name != "*" and name not in known:
            close = difflib.get_close_matches(name, known, n=1)
            mend = f"Did you mean `{close[0]}`?" if close else f"It has {', '.join(sorted(known)[:8])} …"
            found = f"`{module}` has no `{name}`."
            problems.append(Problem(file, item.fence.first_code_line + line - 1, found, mend))
    return problems


def _own_names(module: str, own_interfaces: Iterable[str]) -> frozenset[str]:
    """The names of a module such as `my_interfaces.msg` that the course defines itself."""
    beginning = module.replace(".", "/") + "/"
    return frozenset(name.removeprefix(beginning) for name in own_interfaces if name.startswith(beginning))


def unknown_executables(item: Classified, package: str, executables: Iterable[str], file: Path) -> list[Problem]:
    """Each `ros2 run PACKAGE EXECUTABLE` of a shell fence that nothing here provides.

    `package` is the course's own, `executables` those that its node cells make.
    """
    problems = []
    for command in item.commands:
        words = [word for word in command.words[2:] if not word.startswith("-")]
        if command.kind is not CommandKind.ROS2 or command.words[1] != "run" or not words:
            continue
        line = item.fence.first_code_line + command.line - 1
        name = words[0]
        if name not in {package, "turtlesim"} and name not in ros_packages():
            known = ", ".join(sorted({package, "turtlesim"}))
            close = difflib.get_close_matches(name, [*ros_packages(), package, "turtlesim"], n=1)
            mend = f"Did you mean `{close[0]}`?" if close else f"A chapter can run what these have: {known}."
            problems.append(Problem(file, line, f"there is no package `{name}` here.", mend))
        elif name == package and len(words) > 1 and words[1] not in executables:
            found = f"the course's package `{package}` has no executable `{words[1]}`."
            mend = f"Its node cells make these: {', '.join(sorted(executables)) or 'none'}."
            problems.append(Problem(file, line, found, mend))
    return problems


@functools.cache
def _is_installed(module: str) -> bool:
    if module in sys.stdlib_module_names:
        return True
    try:
        return importlib.util.find_spec(module) is not None
    except (ImportError, ValueError):
        return False


def _similar(module: str, own: frozenset[str]) -> str:
    close = difflib.get_close_matches(module, [*own, *ros_packages(), "rclpy", "numpy", "matplotlib"], n=1, cutoff=0.75)
    return f"Did you mean `{close[0]}`? " if close else ""


@functools.cache
def ros_packages() -> frozenset[str]:
    """The ROS packages of this environment."""
    return frozenset(prefixes.packages(prefixes.installed()))


@functools.cache
def interfaces_of(module: str) -> frozenset[str]:
    """The names that `sensor_msgs.msg` and the like have, from the interface files; empty for any other module."""
    match = re.fullmatch(r"(\w+)\.(msg|srv|action)", module)
    if not match:
        return frozenset()
    package, kind = match.groups()
    interfaces = interface_files.interfaces_of(package) or []
    return frozenset(name.partition("/")[2] for name in interfaces if name.startswith(f"{kind}/"))
