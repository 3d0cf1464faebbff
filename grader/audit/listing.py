"""Lists an exercise's checks as their author wrote them, and takes the time of each."""

from __future__ import annotations

import contextlib
import inspect
import io
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from grader.checking.check import mark_of
from grader.checking.judging import run_pytest
from grader.checking.plugin import Checks
from grader.checking.run import Run
from grader.exercise import Exercise
from grader.recording import Recording
from grader.sandbox import Nursery


@dataclass(frozen=True)
class Check:
    """One check as its author wrote it.

    `scenarios` are those it asks for, `rule` is the sentence of the task on which it stands. `seconds` is how long it
    took to judge the solution. `file` and `line` are where it is.
    """

    name: str
    title: str
    points: float
    hint: str
    depends: tuple[str, ...]
    rule: str
    hidden: bool
    scenarios: tuple[str, ...]
    file: Path
    line: int
    seconds: float


@dataclass(frozen=True)
class ChecksJob:
    """List the checks of an exercise, in the order in which they stand, with the time that each takes."""

    exercise: Exercise
    references: dict[str, Recording]

    def run(self, nursery: Nursery, ready: Callable[[], None]) -> Any:
        """A tuple of `Check`. Raises `ExerciseError` where the files of checks are unusable."""
        ready()
        runs = {name: Run(self.exercise, recording, recording) for name, recording in self.references.items()}
        listing = _Listing(set(runs))
        with contextlib.redirect_stdout(io.StringIO()):
            run_pytest(self.exercise, runs, listing)
        return tuple(listing.listed.values())


class _Listing(Checks):
    def __init__(self, scenarios: set[str]) -> None:
        super().__init__()
        self._scenarios = scenarios
        self.listed: dict[str, Check] = {}

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_call(self, item: pytest.Item) -> Any:
        """Take the time of one check."""
        began = time.perf_counter()
        try:
            return (yield)
        finally:
            self.listed[item.name] = self._listed(item, time.perf_counter() - began)

    def _listed(self, item: Any, seconds: float) -> Check:
        function = inspect.unwrap(item.function)
        mark = mark_of(function)
        assert mark
        return Check(
            name=item.name,
            title=(inspect.getdoc(function) or "").replace("\n", " "),
            points=mark.points,
            hint=mark.hint,
            depends=mark.depends,
            rule=mark.rule,
            hidden=item.path.name == "hidden_checks.py",
            scenarios=tuple(name for name in item.fixturenames if name in self._scenarios),
            file=item.path,
            line=function.__code__.co_firstlineno,
            seconds=seconds,
        )
