"""Reads the chapters of a course; each can use what the others define."""

from __future__ import annotations

from collections.abc import Iterator

from spinbook.chapter.labels import Label
from spinbook.chapter.read import ReadResult, Surroundings, labels_of, modules_of, read_chapter, title_of
from spinbook.course.course import Course
from spinbook.interfaces.definitions import collect


def surroundings(course: Course) -> Surroundings:
    """Return what any chapter of the course may refer to; modules are found by the titles of fences."""
    modules: set[str] = set()
    for file in course.chapters:
        modules |= modules_of(course.root, file)
    collected = collect(course)
    interfaces = {item.full_name: item.text for item in collected.definitions}
    labels: dict[str, Label] = {}
    for file in course.chapters:
        labels = labels_of(course.root, file) | labels
    titles = {file: title_of(course.root, file) for file in course.chapters}
    return Surroundings(
        course.package.name,
        frozenset(modules),
        course.exercises,
        course.names,
        interfaces,
        labels,
        titles,
        collected.not_compiled,
    )


def read_all(course: Course) -> Iterator[ReadResult]:
    """Read every chapter, in the course's order."""
    known = surroundings(course)
    for file in course.chapters:
        yield read_chapter(course.root, file, known)
