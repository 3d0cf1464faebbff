"""Mutants that no check catches, and the author's decisions about them in exercises/NAME/survivors.toml."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

from grader.audit.mutants.maker import Mutant
from grader.audit.result import AuditProblem, Fate, MutantResult, Trial
from grader.exercise.exercise import Exercise, ExerciseError
from grader.exercise.exercise_toml import read_toml
from grader.grading.reference import solution_file

NOW = {
    "caught": "a check catches it now",
    "equivalent": "it no longer differs from the solution",
    "gone": "this mutant no longer exists",
}


def survivors_file(exercise: Exercise) -> Path:
    """Return the file that lists them."""
    return exercise.folder / "survivors.toml"


def listed(exercise: Exercise) -> dict[str, str]:
    """Return the author's reasons, by mutant id. Raises `ExerciseError` if the file can't be read."""
    file = survivors_file(exercise)
    if not file.exists():
        return {}
    reasons: dict[str, str] = {}
    for entry in read_toml(file).get("survivor", []):
        mutant, reason = entry.get("mutant"), entry.get("reason")
        if not isinstance(mutant, str) or not isinstance(reason, str) or not reason.strip():
            raise ExerciseError(file, f"an entry is {entry}", 'Give each a mutant = "…" and a reason = "…".')
        reasons[mutant] = reason
    return reasons


def stale(exercise: Exercise, reasons: dict[str, str], fates: dict[str, Fate]) -> list[AuditProblem]:
    """Return the entries that are out of date."""
    file = survivors_file(exercise)
    lines = file.read_text(encoding="utf-8").splitlines() if reasons else []
    problems = []
    for id_ in reasons:
        fate = fates.get(id_, "gone")
        if fate in NOW:
            line = next((i for i, text in enumerate(lines, start=1) if id_ in text), 1)
            message = f"the mutant {id_} is listed as a survivor, but {NOW[fate]}"
            problems.append(AuditProblem(file, line, message, "Remove the entry.", about=id_))
    return problems


QUESTION = "Is this a right solution? Then list it in {}, as mutant = {!r}, with a reason. If not, add a check."


def result_of(mutant: Mutant, trial: Trial, reasons: dict[str, str], many_answers: bool = False) -> MutantResult:
    """Return the result of one mutant, with the evidence.

    With `many_answers`, one that differs from the solution and that no check refuses is another right answer.
    """
    if trial.caught:
        first = trial.failed[0]
        message = trial.message or trial.findings[first].text
        return MutantResult(mutant, "caught", trial.failed, f"{first}: {message}")
    if not trial.differences:
        messages = f"all {trial.messages} messages of {len(trial.run_in)} scenarios"
        return MutantResult(mutant, "equivalent", (), f"{messages}, the graph and the end are the solution's")
    fate: Fate = "listed" if mutant.id in reasons else "equivalent" if many_answers else "survived"
    return MutantResult(mutant, fate, (), _evidence(trial), reasons.get(mutant.id, ""))


def _evidence(trial: Trial) -> str:
    """Return the differences that no check catches, each with the scenarios in which it was seen."""
    seen = Counter(difference.description for difference in trial.differences)
    first = {difference.description: difference.scenario for difference in reversed(trial.differences)}
    text = [
        f"{text} (in {first[text]}{f' and {count - 1} more' if count > 1 else ''})"
        for text, count in seen.most_common(4)
    ]
    return "; ".join([*text, *([f"and {len(seen) - 4} more"] if len(seen) > 4 else [])])


def problems_of_survivors(exercise: Exercise, results: tuple[MutantResult, ...]) -> list[AuditProblem]:
    """Return a question for each mutant that no check catches and that has no reason."""
    file = survivors_file(exercise)
    return [
        AuditProblem(
            solution_file(exercise),
            result.mutant.line,
            f"no check catches the mutant {result.mutant.id}: {result.mutant.what}",
            QUESTION.format(file.name, result.mutant.id),
            about=result.mutant.id,
            diff=result.mutant.diff,
            evidence=f"It differs from the solution: {result.evidence}.",
        )
        for result in results
        if result.fate == "survived"
    ]
