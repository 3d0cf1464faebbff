"""What an exercise tells its students: every rule of the hidden checks, and never the solution."""

from __future__ import annotations

import re

from grader.audit.listing import Check
from grader.audit.result import Problem
from grader.exercise import Exercise, starter
from grader.grading.reference import solution_file

#: A line of the solution that is shorter than this gives nothing away: `else:`, `return`, `pass`.
SHORTEST = 12


def problems_in_text(exercise: Exercise, checks: tuple[Check, ...]) -> list[Problem]:
    """Hidden checks without their sentence in the task; hints and titles that hold a line of the solution."""
    return [*_rules(exercise, checks), *_giveaways(exercise, checks)]


def _rules(exercise: Exercise, checks: tuple[Check, ...]) -> list[Problem]:
    task = _plain(exercise.task)
    found = []
    for check in checks:
        place = f"{check.file}:{check.line}"
        if check.hidden and not check.rule:
            told = f"the hidden check {check.name} does not name the sentence of the task on which it stands"
            found.append(Problem(place, check.name, told, 'Add rule="…" to @check, with the sentence of task.md.'))
        elif check.rule and _plain(check.rule) not in task:
            told = f"{check.name} stands on a sentence that is not in the task: “{check.rule}”"
            found.append(Problem(place, check.name, told, "Write the sentence in task.md, or name the one there is."))
    return found


def _plain(text: str) -> str:
    """Without Markdown's marks, and with one space wherever there is some."""
    return " ".join(re.sub(r"[*`]", "", text).split())


def _giveaways(exercise: Exercise, checks: tuple[Check, ...]) -> list[Problem]:
    source = solution_file(exercise).read_text(encoding="utf-8")
    given = {_squeezed(line) for line in starter(source).splitlines()}
    lines = {line.split("  #")[0].strip() for line in source.splitlines() if not line.strip().startswith("#")}
    secret = {_squeezed(line): line for line in lines if len(line) >= SHORTEST and _squeezed(line) not in given}
    found = []
    for check in checks:
        for name, text in (("hint", check.hint), ("title", check.title)):
            for squeezed, line in secret.items():
                if squeezed in _squeezed(text):
                    told = f"the {name} of {check.name} holds a line of the solution: {line}"
                    mend = "Say where to look, not what to write."
                    found.append(Problem(f"{check.file}:{check.line}", check.name, told, mend))
    return found


def _squeezed(text: str) -> str:
    return re.sub(r"\s", "", text).replace('"', "'")
