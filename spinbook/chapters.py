"""Reads the chapters of a course; each can use what the others define."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from spinbook.chapter.chapter import ChapterCell
from spinbook.chapter.labels import Label
from spinbook.chapter.read import ReadResult, labels_of, modules_of, read_chapter, text_of, title_of
from spinbook.chapter.surroundings import Surroundings
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
    known = Surroundings(
        course.package.name,
        frozenset(modules),
        course.exercises,
        course.names,
        interfaces,
        labels,
        titles,
        collected.not_compiled,
    )
    return replace(known, earlier_programs=_EarlierChapters(course, known).program)


class _EarlierChapters:
    """The chapters of a course; each is read when a later one runs a program that it may show."""

    def __init__(self, course: Course, known: Surroundings) -> None:
        self._course, self._known = course, known
        self._nodes: dict[Path, list[ChapterCell]] = {}

    def program(self, chapter: Path, package: str, executable: str) -> ChapterCell | None:
        """Return the last program before a chapter that `ros2 run` knows by these names; None if there is none."""
        stem = executable.removesuffix(".py")
        for file in reversed(self._course.chapters[: self._course.chapters.index(chapter)]):
            text = text_of(self._course.root, file)
            if stem not in text or (package != self._course.package.name and package not in text):
                continue
            entry = re.search(rf"\b{re.escape(executable)}\s*=\s*[\"']?{re.escape(package)}\.(\w+):", text)
            names = {stem, entry[1] if entry else stem}
            for cell in reversed(self._nodes_of(file)):
                if cell.name in names or (package, executable) in cell.executables:
                    return replace(cell, shown_in=file)
        return None

    def _nodes_of(self, file: Path) -> list[ChapterCell]:
        if file not in self._nodes:
            read = read_chapter(self._course.root, file, self._known).chapter
            self._nodes[file] = list(read.nodes) if read else []
        return self._nodes[file]


def read_all(course: Course) -> Iterator[ReadResult]:
    """Read every chapter, in the course's order."""
    known = surroundings(course)
    for file in course.chapters:
        yield read_chapter(course.root, file, known)
