"""AuthorCode of the author's that runs inside the grader: a function or a class of a file in the exercise's folder."""

from __future__ import annotations

import hashlib
import importlib
import importlib.util
import inspect
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any


@dataclass(frozen=True)
class AuthorCode:
    """A function or a class called `name`, in `file`, or in a module of the grader's such as `grader.scenario.models`.

    `digest` is the SHA-256 of the file's text. The code is named and not held, because it has to reach a process in
    which the file was not imported.
    """

    file: str
    name: str
    digest: str = ""

    def load(self) -> Any:
        """The function or class itself. Raises what importing the file raises, and AttributeError."""
        if self.is_the_graders:
            return getattr(importlib.import_module(self.file), self.name)
        return getattr(_module(self.file, self.digest), self.name)

    @property
    def is_the_graders(self) -> bool:
        """Whether it comes with the grader, and not from an author's file."""
        return self.file.startswith("grader.")

    def for_students(self) -> AuthorCode:
        """The same by its file's name alone, as in a student's copy of the exercise's folder."""
        return self if self.is_the_graders else AuthorCode(Path(self.file).name, self.name)

    def in_folder(self, folder: Path) -> AuthorCode:
        """The same in a student's copy of the exercise's folder. Raises OSError where the file is missing."""
        if self.is_the_graders:
            return self
        file = folder / Path(self.file).name
        return AuthorCode(str(file), self.name, digest_of(file))


def code_of(given: Callable[..., Any]) -> AuthorCode:
    """Where a function or a class is. Raises `ValueError` for one that has no name of its own, such as a lambda."""
    name = getattr(given, "__qualname__", "")
    if not name.isidentifier():
        raise ValueError(f"{name or given!r} is not a function or a class at the top level of a file")
    if given.__module__.startswith("grader."):
        return AuthorCode(given.__module__, name)
    file = Path(inspect.getfile(given)).resolve()
    return AuthorCode(str(file), name, digest_of(file))


def digest_of(file: Path) -> str:
    """The SHA-256 of a file's text."""
    return hashlib.sha256(file.read_bytes()).hexdigest()


@lru_cache(maxsize=8)
def _module(file: str, digest: str) -> Any:
    spec = importlib.util.spec_from_file_location(f"author_{digest[:12]}", file)
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


#: The file in which an author declares scenarios.
AUTHORS_FILE = "scenarios.py"


def line_of_the_author() -> int:
    """The line of the innermost call in a scenarios.py, or 0 outside of one."""
    frame = sys._getframe(1)
    while frame is not None:
        if frame.f_code.co_filename.endswith(f"/{AUTHORS_FILE}"):
            return frame.f_lineno
        frame = frame.f_back  # type: ignore[assignment]  # None at the end
    return 0
