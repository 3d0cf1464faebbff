"""Collects the interfaces that a course defines, and compiles them in build/interfaces/."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from groundwork.problem import Problem
from interface_compiler import activation, prefixes, store
from interface_compiler.checks import check
from interface_compiler.definition import CompileError, Definition, DefinitionError, Fault, by_package, read_folder
from interface_compiler.near import make_current, use
from interface_compiler.store import CompiledPackages
from spinbook.chapter.fence import interface_package, interface_path, is_someone_elses
from spinbook.chapter.read import fences_of
from spinbook.course.course import FILE, Course
from spinbook.problem import SpinbookError

#: The course's folder with definitions: interfaces/PACKAGE/{msg,srv,action}/.
FOLDER = "interfaces"
#: Finds chapters that may contain a definition. Most do not, and then need not be read.
_HAS_ONE = re.compile(rb"\b(msg|srv|action)/[\w-]+\.\1\b")


@dataclass(frozen=True)
class CourseDefinitions:
    """A course's definitions, each with the file and line that it is from, and what could not be read."""

    definitions: tuple[Definition, ...]
    problems: tuple[Problem, ...]

    @property
    def packages(self) -> tuple[str, ...]:
        """The packages, sorted."""
        return tuple(sorted({item.package for item in self.definitions}))


def collect(course: Course) -> CourseDefinitions:
    """Return every definition of a course. A definition that is in two chapters with the same text counts once."""
    definitions, faults = read_folder(course.root / FOLDER, course.root)
    known = {(item.full_name, item.text) for item in definitions}
    for item in _in_chapters(course):
        if (item.full_name, item.text) not in known:
            known.add((item.full_name, item.text))
            definitions.append(item)
    return CourseDefinitions(tuple(definitions), tuple(problems(faults)))


def checked(course: Course) -> CourseDefinitions:
    """Collect a course's definitions and check them. Raises SpinbookError with every fault."""
    collected = collect(course)
    faults = check(collected.definitions, prefixes.interfaces(prefixes.installed()))
    if errors := [*collected.problems, *problems(faults)]:
        raise SpinbookError(*errors)
    return collected


def problems(faults: Iterable[Fault]) -> Iterator[Problem]:
    """Return the compiler's faults as problems in the author's files."""
    return (Problem(fault.file, fault.line, fault.problem, fault.fix) for fault in faults)


def _in_chapters(course: Course) -> Iterator[Definition]:
    for file in course.chapters:
        try:
            if not _HAS_ONE.search((course.root / file).read_bytes()):
                continue
        except OSError:
            continue
        yield from _in_chapter(course, file)


def _in_chapter(course: Course, file: Path) -> Iterator[Definition]:
    own = interface_package(course.package.name)
    for fence in fences_of(course.root, file):
        path = interface_path(fence.title or "", own) if not fence.has("static") else None
        if path and not is_someone_elses(path.partition("/")[0], own):
            package, kind, name = path.split("/")
            yield Definition(package, kind, name.rpartition(".")[0], fence.code, file, fence.first_code_line)


def folder_of(course: Course) -> Path:
    """Return the folder with the compiled interfaces of a course."""
    return course.build_folder / "interfaces"


def compile_course(course: Course, collected: CourseDefinitions | None = None) -> CompiledPackages | None:
    """Compile a course's interfaces, if it has any and they have changed, and use them in this process from now on.

    Raises:
        SpinbookError: with every fault in the definitions, or where this machine can't compile.
    """
    collected = collected or collect(course)
    if collected.problems:
        raise SpinbookError(*collected.problems)
    if not collected.definitions or _are_sourced(collected):
        return None
    try:
        compiled = store.ensure(collected.definitions, folder_of(course))
    except DefinitionError as error:
        raise SpinbookError(*problems(error.faults)) from None
    except CompileError as error:
        problem = f"the course's interfaces ({', '.join(collected.packages)}) can't be compiled."
        raise SpinbookError(Problem(FILE, None, problem, str(error))) from None
    make_current(folder_of(course), compiled.prefix)
    use(compiled.prefix, folder_of(course))
    return compiled


def _are_sourced(collected: CourseDefinitions) -> bool:
    """Return whether a sourced workspace has all definitions, built by colcon from the same text."""
    places = [prefix for prefix in prefixes.installed() if prefix not in activation.active()]
    return all(
        store.is_installed(package, members, places) for package, members in by_package(collected.definitions).items()
    )
