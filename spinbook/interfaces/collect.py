"""Where a course defines interfaces: in its folder interfaces/, and in fences titled `msg/NAME.msg` and the like."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from interface_compiler import prefixes
from interface_compiler.checks import check
from interface_compiler.definition import Definition, Fault, read_folder
from spinbook.chapter.definition_title import interface_path, is_someone_elses
from spinbook.chapter.markdown import outline
from spinbook.chapter.source import read_source
from spinbook.course.course import Course
from spinbook.problem import Problem, SpinbookError

#: The course's folder with definitions: interfaces/PACKAGE/{msg,srv,action}/.
FOLDER = "interfaces"
#: Whether a chapter can hold a definition at all: most do not, and are not read for it.
_HAS_ONE = re.compile(rb"""^[`~]{3,}.*\btitle=["']?[\w/]*\b(msg|srv|action)/[\w-]+\.\1\b""", re.MULTILINE)


@dataclass(frozen=True)
class Collected:
    """A course's definitions, each with the file and line that it is from, and what could not be read."""

    definitions: tuple[Definition, ...]
    problems: tuple[Problem, ...]

    @property
    def packages(self) -> tuple[str, ...]:
        """The packages, sorted."""
        return tuple(sorted({item.package for item in self.definitions}))


def collect(course: Course) -> Collected:
    """Every definition of a course. A definition that is in two chapters with the same text counts once."""
    definitions, faults = read_folder(course.root / FOLDER, course.root)
    known = {(item.full_name, item.text) for item in definitions}
    for item in _in_chapters(course):
        if (item.full_name, item.text) not in known:
            known.add((item.full_name, item.text))
            definitions.append(item)
    return Collected(tuple(definitions), tuple(problems(faults)))


def checked(course: Course) -> Collected:
    """The same, of a course whose definitions have no faults. Raises SpinbookError with each fault there is."""
    collected = collect(course)
    faults = check(collected.definitions, prefixes.interfaces(prefixes.installed()))
    if found := [*collected.problems, *problems(faults)]:
        raise SpinbookError(*found)
    return collected


def problems(faults: Iterable[Fault]) -> Iterator[Problem]:
    """What the compiler says of definitions, as problems of an author's files."""
    return (Problem(fault.file, fault.line, fault.found, fault.fix) for fault in faults)


def _in_chapters(course: Course) -> Iterator[Definition]:
    for file in course.chapters:
        try:
            if not _HAS_ONE.search((course.root / file).read_bytes()):
                continue
        except OSError:
            continue
        yield from _in_chapter(course, file)


def _in_chapter(course: Course, file: Path) -> Iterator[Definition]:
    source, _ = read_source(course.root / file, file)
    if source is None:
        return
    for span in outline(source.text, file)[0].spans:
        fence = span.fence
        if fence is None or fence.has("static"):
            continue
        own = f"{course.package.name}_interfaces"
        path = interface_path(fence.title or "", own)
        if path and not is_someone_elses(path.partition("/")[0], own):
            package, kind, name = path.split("/")
            yield Definition(package, kind, name.rpartition(".")[0], fence.code, file, fence.first_code_line)
