"""Compiles the interfaces of a course and finds what was compiled, in its folder build/interfaces/."""

from __future__ import annotations

from pathlib import Path

from interface_compiler import activation, store
from interface_compiler.definition import CompileError, DefinitionError
from interface_compiler.store import Compiled
from spinbook.course.course import FILE, Course
from spinbook.interfaces.collect import Collected, collect, problems
from spinbook.problem import Problem, SpinbookError
from spinbook.written import write_if_changed

#: Names the prefix that is the newest, in the store's folder.
_CURRENT = "current"


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
    if not collected.definitions:
        return None
    try:
        compiled = store.ensure(collected.definitions, folder_of(course))
    except DefinitionError as error:
        raise SpinbookError(*problems(error.faults)) from None
    except CompileError as error:
        names = ", ".join(collected.packages)
        raise SpinbookError(
            Problem(FILE, None, f"the course's interfaces ({names}) can't be compiled.", str(error))
        ) from None
    make_current(folder_of(course), compiled.prefix)
    use(compiled.prefix, folder_of(course))
    return compiled


def make_current(folder: Path, prefix: Path) -> None:
    """Note which of a store's prefixes is in use, for processes that begin later."""
    write_if_changed(folder / _CURRENT, prefix.name + "\n")


def use(prefix: Path, folder: Path) -> None:
    """Use a store's prefix in this process and those that it starts, in place of earlier ones of the same store."""
    earlier = [old for old in activation.active() if old.parent == folder.resolve() and old != prefix]
    activation.activate(prefix, earlier)


def current(folder: Path) -> Path | None:
    """The prefix that was made current in a store, if it is there."""
    try:
        prefix = folder.resolve() / (folder / _CURRENT).read_text(encoding="utf-8").strip()
    except OSError:
        return None
    return prefix if prefix.is_dir() and prefix.name else None


def use_near(start: Path) -> Path | None:
    """Use what was compiled for the course in whose folder, or below it, `start` is; the prefix, if there is one."""
    for folder in (start.absolute(), *start.absolute().parents):
        if (folder / FILE).is_file():
            store_folder = folder / "build" / "interfaces"
            prefix = current(store_folder)
            if prefix is not None:
                use(prefix, store_folder)
            return prefix
    return None
