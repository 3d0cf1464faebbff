"""An exercise's checks as their author wrote them, their times, and what students see of them."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from grader.audit.result import AuditProblem
from grader.checking.judge import run_pytest
from grader.checking.plugin import Checks
from grader.checking.proofreader import rule_that_the_task_lacks
from grader.checking.run import Run
from grader.checking.verdict import ListedCheck
from grader.exercise.exercise import Exercise
from grader.exercise.starter import starter
from grader.grading.reference import solution_file
from grader.recording.recording import Recording

if TYPE_CHECKING:
    from grader.sandbox.fork_server import ForkServer  # the worker passes it


@dataclass(frozen=True)
class ChecksJob:
    """List the checks of an exercise, in the order of the files, with the time that each takes."""

    exercise: Exercise
    references: dict[str, Recording]

    def run(self, fork_server: ForkServer, ready: Callable[[], None]) -> Any:
        """Return a tuple of `ListedCheck`. Raises `ExerciseError` if the files of checks are unusable."""
        ready()
        runs = {name: Run(self.exercise, recording, recording) for name, recording in self.references.items()}
        checks = Checks()
        run_pytest(self.exercise, runs, checks)
        return tuple(checks.listed.values())


#: A line of the solution that is shorter than this reveals nothing: `else:`, `return`, `pass`.
SHORTEST = 12


def problem_of(check: ListedCheck, problem: str, fix: str) -> AuditProblem:
    """Return a problem of this check."""
    return AuditProblem(check.file, check.line, problem, fix, about=check.name)


def problems_in_text(exercise: Exercise, checks: tuple[ListedCheck, ...]) -> list[AuditProblem]:
    """Return hidden checks without a sentence in the task, and hints and titles that contain a line of the solution."""
    return [*_rules(exercise, checks), *_giveaways(exercise, checks)]


def _rules(exercise: Exercise, checks: tuple[ListedCheck, ...]) -> list[AuditProblem]:
    problems = []
    for check in checks:
        if check.hidden and not check.rules:
            text = f"the hidden check {check.name} does not name the sentence of the task that it is based on"
            problems.append(problem_of(check, text, 'Add rule="…" to @check, with the sentence of task.md.'))
        for rule in check.rules:
            for error in rule_that_the_task_lacks(exercise.task, rule, check.file, check.line):
                problems.append(problem_of(check, error.problem.problem, error.problem.fix))
    return problems


def _giveaways(exercise: Exercise, checks: tuple[ListedCheck, ...]) -> list[AuditProblem]:
    source = solution_file(exercise).read_text(encoding="utf-8")
    in_starter = {_squeezed(line) for line in starter(source).splitlines()}
    lines = {line.split("  #")[0].strip() for line in source.splitlines() if not line.strip().startswith("#")}
    secret = {_squeezed(line): line for line in lines if len(line) >= SHORTEST and _squeezed(line) not in in_starter}
    problems = []
    for check in checks:
        for name, text in (("hint", check.hint), ("todo", check.todo), ("title", check.title)):
            for squeezed, line in secret.items():
                if squeezed in _squeezed(text):
                    message = f"the {name} of {check.name} contains a line of the solution: {line}"
                    fix = "Say where to look, not what to write."
                    problems.append(problem_of(check, message, fix))
    return problems


def _squeezed(text: str) -> str:
    return re.sub(r"\s", "", text).replace('"', "'")
