"""Compiles the interfaces of a course, in its folder build/interfaces/."""

from __future__ import annotations

from pathlib import Path

from interface_compiler import activation, prefixes, store
from interface_compiler.definition import CompileError, DefinitionError, by_package
from interface_compiler.near import make_current, use
from interface_compiler.store import Compiled
from spinbook.course.course import FILE, Course
from spinbook.interfaces.collect import Collected, collect, problems
from spinbook.problem import Problem, SpinbookError


def folder_of(course: Course) -> Path:
    """The folder with the compiled interfaces of a course."""
    return course.build_folder / "interfaces"


def compile_course(course: Course, collected: Collected | None = None) -> Compiled | None:
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
        found = f"the course's interfaces ({', '.join(collected.packages)}) can't be compiled."
        raise SpinbookError(Problem(FILE, None, found, str(error))) from None
    make_current(folder_of(course), compiled.prefix)
    use(compiled.prefix, folder_of(course))
    return compiled


def _are_sourced(collected: Collected) -> bool:
    """Whether a sourced workspace has them all, built by colcon from the same text."""
    places = [prefix for prefix in prefixes.installed() if prefix not in activation.active()]
    return all(
        store.is_installed(package, members, places) for package, members in by_package(collected.definitions).items()
    )
