"""Wheels for students: Spinbook without the parts for authors, its middleware, and compiled interfaces."""

from __future__ import annotations

import platform
import re
import sys
from collections.abc import Iterable, Iterator
from pathlib import Path

from grader.gradescope.own_wheel import as_wheel, wheel_contents
from interface_compiler import prefixes, shipped
from interface_compiler.checks import dependencies
from interface_compiler.wheel import wheel
from spinbook.course.course import Course
from spinbook.interfaces.definitions import FOLDER, collect, compile_course

#: The templates of `spinbook new` contain solutions and hidden checks; courses may still use them.
FOR_AUTHORS = ("spinbook/new/template/", "spinbook/new/kinds/")


def spinbook_wheel() -> tuple[str, bytes]:
    """Return the wheel's file name and content. Raises NoWheel if it can't be made."""
    kept = {name: content for name, content in wheel_contents().items() if not name.startswith(FOR_AUTHORS)}
    # Without the project's README below its header, which has examples from a course in it.
    described = next(name for name in kept if name.endswith(".dist-info/METADATA"))
    kept[described] = kept[described].partition(b"\n\n")[0] + b"\n"
    return as_wheel(kept)


#: Where a course keeps wheels that were compiled for other processors.
OTHERS = Path(FOLDER, "wheels")


def interface_wheels(course: Course, texts: Iterable[bytes], environment: Path = Path(sys.prefix)) -> dict[str, bytes]:
    """Return file name -> content of each wheel: the course's own packages, and those beyond PyPI's that it may use.

    `texts` are what students get to read; an optional package is included if it is named there, or if the course's
    interfaces need it. `environment` has the packages that come with Spinbook.

    Raises:
        SpinbookError: if the course's interfaces have faults or can't be compiled.
    """
    own = platform.machine()
    others = (path for path in sorted((course.root / OTHERS).glob("*.whl")) if not path.stem.endswith(f"_{own}"))
    wheels = {path.name: path.read_bytes() for path in others}
    wheels.update(wheel(package, prefix) for package, prefix in _packages(course, b"".join(texts), environment))
    return wheels


def package_of(wheel: str) -> str:
    """Return the ROS package in a wheel of interfaces, from the wheel's file name; empty for other wheels."""
    prefix, _, package = wheel.partition("-")[0].partition("compiled_interfaces_")
    return "" if prefix else package


def _packages(course: Course, text: bytes, environment: Path) -> Iterator[tuple[str, Path]]:
    """Yield the packages, each with the prefix that has it."""
    collected = collect(course)
    compiled = compile_course(course, collected)
    needed = {name for names in dependencies(collected.definitions).values() for name in names}
    for package in shipped.known():
        is_needed = package in shipped.standard() or package in needed or package.encode() in text
        if is_needed and prefixes.key_of(package, environment):
            yield package, environment
    if compiled:
        yield from ((package, compiled.prefix) for package in compiled.packages)


#: The platform in a wheel's name: the system, its oldest version, and the machine, such as manylinux_2_28_x86_64.
_PLATFORM = re.compile(r"[a-z]+(?:_\d+_\d+)?_(?P<machine>\w+)")


def requirement(file: str) -> str:
    """Return the line of requirements.txt for a wheel, with the machine and the Pythons that it was compiled for."""
    version, abi, named = file.removesuffix(".whl").split("-")[2:5]
    read = _PLATFORM.fullmatch(named)
    machine = f'platform_machine == "{read["machine"] if read else named}"'
    if abi in ("abi3", "none"):
        return f"./wheels/{file} ; {machine}"
    return f'./wheels/{file} ; python_version == "3.{version.removeprefix("cp3")}" and {machine}'
