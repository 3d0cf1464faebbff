"""Reads the chapters of a course, each knowing what the others define."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from spinbook.chapter.read import Reading, Surroundings, read_chapter
from spinbook.course.course import Course
from spinbook.interfaces.collect import collect

_TITLE = re.compile(rb"""^[`~]{3,}.*\btitle=["']?(\w+)\.py\b""", re.MULTILINE)


def surroundings(course: Course) -> Surroundings:
    """What any chapter of the course may refer to: modules of every chapter are found by their fences' titles."""
    modules: set[str] = set()
    for file in course.chapters:
        modules |= {name.decode() for name in _TITLE.findall(_bytes(course.root / file))}
    interfaces = frozenset(item.full_name for item in collect(course).definitions)
    return Surroundings(course.package.name, frozenset(modules), course.exercises, interfaces)


def _bytes(file: Path) -> bytes:
    try:
        return file.read_bytes()
    except OSError:
        return b""


def read_all(course: Course) -> Iterator[Reading]:
    """Read every chapter, in the course's order."""
    known = surroundings(course)
    for file in course.chapters:
        yield read_chapter(course.root, file, known)
