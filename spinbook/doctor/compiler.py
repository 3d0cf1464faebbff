"""Whether a course's own messages, services and actions can be compiled here: gcc, g++ and Python.h."""

from __future__ import annotations

import shutil

from interface_compiler import prefixes, shipped, toolchain
from spinbook.doctor.finding import Finding, ok, warning

_WITHOUT = "Only courses that define interfaces of their own need them; a handout's wheels need no compiler."


def examine(name: str) -> Finding:
    """Look for both, and for the packages that set-up compiles with them."""
    if ros := toolchain.sourced_ros():
        return ok(name, f"colcon compiles interfaces, with the ROS 2 in {ros}")
    lacking = list(filter(None, (toolchain.missing_compiler(), toolchain.missing_headers())))
    if lacking:
        return warning(name, _absent(), "\n".join([*lacking, _WITHOUT]))
    installed = prefixes.packages(prefixes.installed())
    absent = [package for package in shipped.standard() if package not in installed]
    if absent:
        return warning(name, f"{' and '.join(absent)} not compiled yet", "make setup compiles them")
    return ok(name, f"{shutil.which('gcc')}, {shutil.which('g++')}, {toolchain.headers() / 'Python.h'}")


def _absent() -> str:
    programs = [program for program in ("gcc", "g++") if shutil.which(program) is None]
    header = [] if (toolchain.headers() / "Python.h").is_file() else ["Python.h"]
    return f"not found: {', '.join([*programs, *header])}"
