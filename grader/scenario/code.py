"""The author's code that runs inside the grader: a function or a class from a file in the exercise's folder."""

from __future__ import annotations

import importlib
import inspect
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from grader.exercise.imported_files import digest_with_modules, imported


@dataclass(frozen=True)
class AuthorCode:
    """A function or a class called `name`, in `file`, or in a module of the grader's such as `grader.scenario.models`.

    `digest` is the SHA-256 of the file's text and of the modules next to it that it imports. The code is stored by
    name, because it is sent to processes that have not imported the file.
    """

    file: str
    name: str
    digest: str = ""

    def load(self) -> Any:
        """Return the function or class itself. Raises AttributeError, and what importing the file raises."""
        if self.is_the_graders:
            return getattr(importlib.import_module(self.file), self.name)
        return getattr(_module(self.file, self.digest), self.name)

    @property
    def is_the_graders(self) -> bool:
        """Whether it belongs to the grader, and not to an author's file."""
        return self.file.startswith("grader.")

    def without_folder(self) -> AuthorCode:
        """Return the same code with the name of its file alone: where a course is, must change no grade."""
        return self if self.is_the_graders else replace(self, file=Path(self.file).name)

    def for_students(self) -> AuthorCode:
        """Return the same code with only the name of its file, as in a student's copy of the exercise's folder."""
        return self if self.is_the_graders else AuthorCode(Path(self.file).name, self.name)

    def in_folder(self, folder: Path) -> AuthorCode:
        """Return the same code in a student's copy of the exercise's folder. Raises OSError if the file is missing."""
        if self.is_the_graders:
            return self
        file = folder / Path(self.file).name
        return AuthorCode(str(file), self.name, digest_with_modules(file))


def code_of(definition: Callable[..., Any]) -> AuthorCode:
    """Return where a function or a class is defined. Raises `ValueError` for one without a name, such as a lambda."""
    name = getattr(definition, "__qualname__", "")
    if not name.isidentifier():
        raise ValueError(f"{name or definition!r} is not a function or a class at the top level of a file")
    if definition.__module__.startswith("grader."):
        return AuthorCode(definition.__module__, name)
    file = Path(inspect.getfile(definition)).resolve()
    return AuthorCode(str(file), name, digest_with_modules(file))


@lru_cache(maxsize=8)
def _module(file: str, digest: str) -> Any:
    return imported(Path(file), f"author_{digest[:12]}")


#: The file in which an author declares scenarios.
AUTHORS_FILE = "scenarios.py"


def line_of_the_author() -> int:
    """Return the line of the innermost call in a scenarios.py, or 0 if there is none."""
    return _place_of_the_author()[1]


def folder_of_the_author() -> Path:
    """Return the folder of the innermost scenarios.py that calls this; the current one if there is none."""
    return Path(_place_of_the_author()[0]).parent


def _place_of_the_author() -> tuple[str, int]:
    frame = sys._getframe(1)
    while frame is not None:
        if frame.f_code.co_filename.endswith(f"/{AUTHORS_FILE}"):
            return frame.f_code.co_filename, frame.f_lineno
        frame = frame.f_back  # type: ignore[assignment]  # None at the end
    return "", 0
