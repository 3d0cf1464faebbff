"""What became of each mutant, and what is asked of the author where no check caught it."""

from __future__ import annotations

from collections import Counter

from grader.audit.mutants import Mutant
from grader.audit.result import Fate, MutantResult, Problem
from grader.audit.survivors import survivors_file
from grader.audit.trial import Trial
from grader.exercise import Exercise

QUESTION = "Is this a right solution? Then list it in {}, as mutant = {!r}, with a reason. If not, add a check."


def result_of(mutant: Mutant, trial: Trial, reasons: dict[str, str]) -> MutantResult:
    """What became of one mutant, with the evidence."""
    if trial.caught:
        first = trial.failed[0]
        told = trial.story or trial.findings[first].text
        return MutantResult(mutant, "caught", trial.failed, f"{first}: {told}")
    if not trial.differences:
        same = f"all {trial.messages} messages of {len(trial.spun)} scenarios, the graph and the end are the solution's"
        return MutantResult(mutant, "equivalent", (), same)
    fate: Fate = "listed" if mutant.id in reasons else "survived"
    return MutantResult(mutant, fate, (), _evidence(trial), reasons.get(mutant.id, ""))


def _evidence(trial: Trial) -> str:
    """The differences that no check minds, each with the scenarios it was seen in."""
    seen = Counter(difference.what for difference in trial.differences)
    first = {difference.what: difference.scenario for difference in reversed(trial.differences)}
    told = [
        f"{what} (in {first[what]}{f' and {count - 1} more' if count > 1 else ''})"
        for what, count in seen.most_common(4)
    ]
    return "; ".join([*told, *([f"and {len(seen) - 4} more"] if len(seen) > 4 else [])])


def problems_of_survivors(exercise: Exercise, results: tuple[MutantResult, ...]) -> list[Problem]:
    """A question for each mutant that no check catches and nobody has judged."""
    file = survivors_file(exercise)
    return [
        Problem(
            f"{exercise.solution_file}:{result.mutant.line}",
            result.mutant.id,
            f"no check catches the mutant {result.mutant.id}: {result.mutant.what}",
            QUESTION.format(file.name, result.mutant.id),
            result.mutant.diff,
            f"It can be told from the solution: {result.evidence}.",
        )
        for result in results
        if result.fate == "survived"
    ]
