"""Compiles a course's interfaces for the exercises that use them, so that grading needs no other command first."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Iterator, Sequence
from pathlib import Path

import click

from grader.exercise.loading import COURSE, NoExercise, find
from interface_compiler import activation, prefixes

#: A type such as `arm_msgs/srv/Move`, or an import from `arm_msgs.srv`.
_USE = re.compile(r"\b([a-z]\w*)/(?:msg|srv|action)/[A-Z]|^\s*from\s+([a-z]\w*)\.(?:msg|srv|action)\s", re.MULTILINE)


def compile_for(words: Sequence[str]) -> None:
    """Compile the interfaces of the course whose exercises these words of a command line name, if they use them.

    Without a name, all exercises here count. Standard error says what is compiled, which takes seconds.

    Raises:
        SpinbookError: if a definition is wrong, or if this machine can't compile.
    """
    folders = list(_named(words)) or sorted(file.parent for file in Path.cwd().glob("exercises/*/exercise.toml"))
    for root in dict.fromkeys(folder.resolve().parents[1] for folder in folders if _uses_more_than_installed(folder)):
        if (root / COURSE).is_file():
            _compile(root)


def _named(words: Sequence[str]) -> Iterator[Path]:
    for word in words:
        with contextlib.suppress(NoExercise, OSError):
            yield find(word, Path.cwd())


def _uses_more_than_installed(exercise: Path) -> bool:
    """Return whether an exercise uses a package of interfaces that is in no prefix, or only in a course's own."""
    places = [prefix for prefix in prefixes.installed() if prefix not in activation.active()]
    return any(prefixes.prefix_of(package, places) is None for package in _packages(exercise))


def _packages(exercise: Path) -> set[str]:
    files = [exercise / "exercise.toml", *exercise.glob("*.py")]
    texts = (file.read_text(encoding="utf-8", errors="replace") for file in files if file.is_file())
    return {use[1] or use[2] for text in texts for use in _USE.finditer(text)}


def _compile(root: Path) -> None:
    # What reads chapters takes long to import, and most exercises don't need it.
    from interface_compiler import store
    from spinbook.course.course import read_course
    from spinbook.interfaces.definitions import collect, compile_course, folder_of

    course = read_course(root)
    collected = collect(course)
    if collected.definitions and not store.find(collected.definitions, folder_of(course)):
        click.echo(f"Compiling the course's interfaces, once ({', '.join(collected.packages)}) ...", err=True)
    compile_course(course, collected)
