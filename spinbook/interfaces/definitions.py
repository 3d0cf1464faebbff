"""Collects the interfaces that a course defines, and compiles them in build/interfaces/."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from groundwork.problem import Problem, Severity
from interface_compiler import activation, prefixes, store
from interface_compiler.checks import check
from interface_compiler.definition import CompileError, Definition, DefinitionError, Fault, by_package, read_folder
from interface_compiler.near import make_current, use
from interface_compiler.store import CompiledPackages
from spinbook.chapter.fence import interface_package, interface_path
from spinbook.chapter.installed_interfaces import is_someone_elses
from spinbook.chapter.read import definitions_of
from spinbook.course.course import FILE, Course
from spinbook.problem import SpinbookError, refuse_errors

#: The course's folder with definitions: interfaces/PACKAGE/{msg,srv,action}/.
FOLDER = "interfaces"
#: Finds chapters that may contain a definition. Most do not, and then need not be read.
_HAS_ONE = re.compile(rb"\w\.(msg|srv|action)\b")


@dataclass(frozen=True)
class CourseDefinitions:
    """A course's definitions, each with the file and line that it is from, and what could not be read.

    `not_compiled` says why definitions that no title names in full are only shown, by the file and line on which each
    begins.
    """

    definitions: tuple[Definition, ...]
    problems: tuple[Problem, ...]
    not_compiled: Mapping[tuple[Path, int], Problem] = field(default_factory=dict)

    @property
    def packages(self) -> tuple[str, ...]:
        """The packages, sorted."""
        return tuple(sorted({item.package for item in self.definitions}))


def collect(course: Course) -> CourseDefinitions:
    """Return every definition of a course. A definition that is in two chapters with the same text counts once."""
    definitions, faults = read_folder(course.root / FOLDER, course.root)
    known = {(item.full_name, item.text) for item in definitions}
    recognized: list[Definition] = []
    for item, titled in _in_chapters(course):
        if (item.full_name, item.text) not in known:
            known.add((item.full_name, item.text))
            (definitions if titled else recognized).append(item)
    good, not_compiled = _without_faults(recognized, definitions)
    return CourseDefinitions((*definitions, *good), tuple(problems(faults)), not_compiled)


def _without_faults(
    recognized: Sequence[Definition], titled: Sequence[Definition]
) -> tuple[list[Definition], dict[tuple[Path, int], Problem]]:
    """Return those of the definitions `recognized` by the text around them that can be compiled; why the others can't.

    A definition that is shown again with other fields is compiled as it was shown last.
    """
    last = {item.full_name: item for item in [*recognized, *titled]}
    faults = {item: _again(item, last[item.full_name]) for item in recognized if last[item.full_name] != item}
    good = [item for item in recognized if item not in faults]
    known = prefixes.interfaces(prefixes.installed()) if good else {}
    while bad := {item: fault for fault in check([*titled, *good], known) for item in good if _is_in(item, fault)}:
        faults |= {item: _not_compiled(item, fault) for item, fault in bad.items()}
        good = [item for item in good if item not in bad]
    return good, {(item.file, item.line): fault for item, fault in faults.items()}


def _is_in(item: Definition, fault: Fault) -> bool:
    first = item.title_line or 1
    return fault.file == item.file and first <= (fault.line or 0) <= item.line + item.text.count("\n")


def _not_compiled(item: Definition, fault: Fault) -> Problem:
    problem = f"`{item.full_name}` is shown and not compiled: {fault.problem}"
    return Problem(item.file, fault.line, problem, fault.fix, Severity.NOT_RUN)


def _again(item: Definition, last: Definition) -> Problem:
    problem = f"`{item.full_name}` is shown and not compiled: {last.file}:{last.line} shows it with other fields."
    return Problem(item.file, item.line, problem, "The last one is compiled.", Severity.WARNING)


def checked(course: Course) -> CourseDefinitions:
    """Collect a course's definitions and check them. Raises SpinbookError with every fault."""
    collected = collect(course)
    faults = check(collected.definitions, prefixes.interfaces(prefixes.installed()))
    refuse_errors([*collected.problems, *problems(faults)])
    return collected


def problems(faults: Iterable[Fault]) -> Iterator[Problem]:
    """Return the compiler's faults as problems in the author's files."""
    return (Problem(fault.file, fault.line, fault.problem, fault.fix) for fault in faults)


def _in_chapters(course: Course) -> Iterator[tuple[Definition, bool]]:
    """Yield each definition in a chapter, and whether its fence's title names it in full."""
    for file in course.chapters:
        try:
            if not _HAS_ONE.search((course.root / file).read_bytes()):
                continue
        except OSError:
            continue
        yield from _in_chapter(course, file)


def _in_chapter(course: Course, file: Path) -> Iterator[tuple[Definition, bool]]:
    own = interface_package(course.package.name)
    for fence, path in definitions_of(course.root, file, own):
        package, kind, name = path.split("/")
        if not is_someone_elses(package, own):
            item = Definition(package, kind, name.rpartition(".")[0], fence.code, file, fence.first_code_line)
            yield item, interface_path(fence.title or "", own) is not None


def folder_of(course: Course) -> Path:
    """Return the folder with the compiled interfaces of a course."""
    return course.build_folder / "interfaces"


def compile_course(course: Course, collected: CourseDefinitions | None = None) -> CompiledPackages | None:
    """Compile a course's interfaces, if it has any and they have changed, and use them in this process from now on.

    Raises:
        SpinbookError: with every fault in the definitions, or where this machine can't compile.
    """
    collected = collected or collect(course)
    refuse_errors(collected.problems)
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
