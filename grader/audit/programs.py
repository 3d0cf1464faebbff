"""Right solutions must get everything, nothing must get nothing, and mistakes must lose what they name."""

from __future__ import annotations

from grader.audit.candidates import Candidate
from grader.audit.listing import Check
from grader.audit.result import Judged, Problem
from grader.audit.trial import Trial


def judged(candidate: Candidate, trial: Trial, checks: tuple[Check, ...]) -> Judged:
    """How a program did."""
    return Judged(candidate.name, candidate.kind, candidate.title, trial.failed, _score(trial, checks))


def problems_of(
    candidates: list[Candidate], trials: dict[str, Trial], checks: tuple[Check, ...], seed: int | None = None
) -> list[Problem]:
    """What did not come out as it has to; `seed` is set where another than the usual one was tried."""
    found: list[Problem] = []
    for candidate in candidates:
        trial = trials[candidate.name]
        if candidate.kind == "nothing":
            found += _nothing(candidate, trial, checks)
        elif candidate.kind == "mistake":
            found += _mistake(candidate, trial, checks)
        else:
            found += _right(candidate, trial, seed)
    return found


def _right(candidate: Candidate, trial: Trial, seed: int | None) -> list[Problem]:
    with_seed = f" with --seed {seed}" if seed is not None else ""
    mend = "Mend the check if the solution is right, else the solution."
    return [
        Problem(
            str(candidate.file),
            name,
            f"the right solution {candidate.name} fails {name}{with_seed}: {trial.findings[name].text}",
            mend,
        )
        for name in trial.failed
    ]


def _nothing(candidate: Candidate, trial: Trial, checks: tuple[Check, ...]) -> list[Problem]:
    mend = "Let it depend on the check that says that anything comes at all."
    return [
        Problem(
            f"{check.file}:{check.line}",
            check.name,
            f"{candidate.name} passes {check.name} and gets {check.points:g} points, where it must get none",
            mend,
        )
        for check in checks
        if trial.statuses.get(check.name) == "passed" and check.points
    ]


def _mistake(candidate: Candidate, trial: Trial, checks: tuple[Check, ...]) -> list[Problem]:
    place = f"{candidate.file}:{candidate.line}"
    said = f"the mistake {candidate.name} (“{candidate.title}”)"
    known = {check.name for check in checks}
    if not candidate.caught_by:
        mend = "Write “Caught by:” in its docstring, and under it each check after “- ”."
        return [Problem(place, candidate.name, f"{said} names no check that is to catch it", mend)]
    found = []
    for name in candidate.caught_by:
        status = trial.statuses.get(name)
        mend = "Mend the check so that it fails, or take it off the list under “Caught by:”."
        if name not in known:
            mend = "Write the check (again), or take it off the list under “Caught by:”."
            found.append(Problem(place, name, f"{said} is to be caught by {name}: there is no such check", mend))
        elif status == "passed":
            found.append(Problem(place, name, f"{name} lets {said} through", mend))
        elif status == "blocked":
            by = ", ".join(trial.failed) or "another check"
            told = f"{name} is to catch {said}, but is blocked: it depends on {by}, which fails"
            found.append(Problem(place, name, told, mend))
    for name in trial.failed:
        if name not in candidate.caught_by:
            told = f"{said} fails {name}, too, which it does not name: {trial.findings[name].text}"
            mend = "Mend the check if this is no mistake in its eyes, else add it under “Caught by:”."
            found.append(Problem(place, name, told, mend))
    return found


def _score(trial: Trial, checks: tuple[Check, ...]) -> float:
    return sum(check.points for check in checks if trial.statuses.get(check.name) == "passed")
