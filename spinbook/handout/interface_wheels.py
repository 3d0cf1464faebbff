"""Compiled interfaces for students, as wheels: with them nobody needs a compiler."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from pathlib import Path

from interface_compiler import shipped, store
from interface_compiler.wheel import wheel
from spinbook.course.course import Course
from spinbook.interfaces.collect import FOLDER
from spinbook.interfaces.compiled import compile_course

#: Where a course keeps wheels that were compiled for other versions of Python.
OTHERS = Path(FOLDER, "wheels")


def interface_wheels(course: Course, texts: Iterable[bytes]) -> dict[str, bytes]:
    """File name -> content of each wheel: the course's own packages, and those beyond PyPI's that it may use.

    `texts` are what students get to read; an optional package goes with them where it is named there.

    Raises:
        SpinbookError: if the course's interfaces have faults or can't be compiled.
    """
    found = {path.name: path.read_bytes() for path in sorted((course.root / OTHERS).glob("*.whl"))}
    found.update(wheel(package, prefix) for package, prefix in _packages(course, b"".join(texts)))
    return found


def _packages(course: Course, text: bytes) -> Iterator[tuple[str, Path]]:
    """The packages, each with the prefix that has it."""
    environment = Path(sys.prefix)
    for package in (*shipped.standard(), *shipped.optional()):
        wanted = package in shipped.standard() or package.encode() in text
        if wanted and store.key_of(package, environment):
            yield package, environment
    if compiled := compile_course(course):
        for package in compiled.packages:
            yield package, compiled.prefix


def requirement(file: str) -> str:
    """The line of a requirements.txt for a wheel, for the Python and the machine that it was compiled for."""
    version, platform = file.removesuffix(".whl").split("-")[2:5:2]
    minor = version.removeprefix("cp3")
    machine = platform.partition("_")[2]
    return f'./wheels/{file} ; python_version == "3.{minor}" and platform_machine == "{machine}"'
