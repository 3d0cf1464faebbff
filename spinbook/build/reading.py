"""Reads the chapters of a course, each knowing what the others define."""

from __future__ import annotations

from collections.abc import Iterator

from spinbook.chapter.read import Reading, Surroundings, modules_of, read_chapter
from spinbook.course.course import Course


def surroundings(course: Course) -> Surroundings:
    """What any chapter of the course may refer to: modules of every chapter are found by their fences' titles."""
    modules: set[str] = set()
    for file in course.chapters:
        modules |= modules_of(course.root, file)
    return Surroundings(course.package.name, frozenset(modules), course.exercises, course.names)


def read_all(course: Course) -> Iterator[Reading]:
    """Read every chapter, in the course's order."""
    known = surroundings(course)
    for file in course.chapters:
        yield read_chapter(course.root, file, known)
