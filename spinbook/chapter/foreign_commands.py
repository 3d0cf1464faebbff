"""Commands about packages that a chapter does not make: whether what they need is here."""

from __future__ import annotations

import re
from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path

from groundwork.words import did_you_mean
from interface_compiler import prefixes
from ros_in_python.example_robots import share_folders
from ros_in_python.ros2 import executables
from spinbook.chapter.imports import IN_ROS, interfaces_of, own_names, remedy, ros_packages
from spinbook.chapter.terminal import Command, is_placeholder

#: Programs that need a keyboard.
READ_KEYS = {("turtlesim", "turtle_teleop_key")}
_TYPE = re.compile(r"(\w+)/(msg|srv|action)/(\w+)")


@dataclass(frozen=True)
class Reason:
    """Why a command can't run here. `group` is what is missing."""

    why: str
    fix: str
    group: str


TO_FILL_IN = Reason(
    "it holds placeholders for what a reader fills in",
    "Write `static` after the language to say that this is meant.",
    "",
)


def foreign_program(package: str, executable: str, course_package: str, own: Collection[str]) -> Reason | None:
    """Return why a program can't run that no fence shows; None if it comes with Spinbook or ROS. `own` are the
    chapter's packages."""
    if (package, executable) in READ_KEYS:
        fix = "Run it in a terminal; write `static` after the language to say that this is meant."
        return Reason(f"`{executable}` reads keys from a terminal", fix, "keys from a terminal")
    there = set(executables.BUILT_IN.get(package, ()))
    if package in ros_packages():
        prefix = prefixes.prefix_of(package, prefixes.installed())
        there |= {path.name for path in executables.in_prefix(prefix, package)} if prefix else set()
    if executable in there:
        needed = executables.interfaces_used(package, executable)
        return lacking(needed) if needed and needed not in ros_packages() else None
    if there:
        meant = did_you_mean(executable, there, "", "`{}`", 0.7)
        fix = f"{meant} It has these: {', '.join(sorted(there))}.".lstrip()
        return Reason(f"`{package}` has no program `{executable}` here", fix, f"programs of {package}")
    if package in own:
        stem = executable.removesuffix(".py")
        fix = f'Show its program in a fence above: ```python title="{stem}.py"'
        return Reason(f"no fence above shows `{executable}` of `{package}`", fix, "programs that no fence shows")
    if is_placeholder(package):
        return TO_FILL_IN
    show = f"Show its program in a fence of the chapter, or {IN_ROS}."
    fix = did_you_mean(package, [course_package, *executables.BUILT_IN, *own], show, "`{}`", 0.85)
    return Reason(f"there is no package `{package}` here", fix, package)


def has_launch_file(package: str, name: str) -> bool:
    """Return whether an installed package has this launch file."""
    shares = share_folders(package) if name and Path(name).name == name else []
    return any(path.is_file() for share in shares for path in share.rglob(name))


def missing_type(command: Command, own_interfaces: Collection[str]) -> Reason | None:
    """Return a reason if a command names an interface type that does not exist."""
    for package, kind, name in _TYPE.findall(command.text):
        own = own_names(f"{package}.{kind}", own_interfaces)
        known = own or interfaces_of(f"{package}.{kind}")
        if not own and package not in ros_packages():
            return lacking(package)
        if known and name not in known:
            fix = did_you_mean(name, known, "See `ros2 interface list`.", "`{}`")
            return Reason(f"`{package}/{kind}` has no `{name}`", fix, "")
    return None


def lacking(package: str) -> Reason:
    """Return that a package of interfaces is missing, with how to get it."""
    if is_placeholder(package):
        return TO_FILL_IN
    return Reason(f"it needs `{package}`, not installed here", remedy(package), package)
