"""The mutants that no check catches and that the author has judged: exercises/NAME/survivors.toml."""

from __future__ import annotations

import sys
from pathlib import Path

from grader.audit.result import Fate, Problem
from grader.exercise import Exercise, ExerciseError

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

NOW = {
    "caught": "a check catches it now",
    "equivalent": "nothing of it can be told from the solution any more",
    "gone": "there is no such mutant any more",
}


def survivors_file(exercise: Exercise) -> Path:
    """Where they are listed."""
    return exercise.folder / "survivors.toml"


def listed(exercise: Exercise) -> dict[str, str]:
    """Mutant's id -> why it is right that no check catches it. Raises `ExerciseError` where that can't be read."""
    file = survivors_file(exercise)
    if not file.exists():
        return {}
    try:
        entries = tomllib.loads(file.read_text(encoding="utf-8")).get("survivor", [])
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ExerciseError(file, f"it can't be read: {error}", "Write it as TOML, in UTF-8.") from None
    reasons: dict[str, str] = {}
    for entry in entries:
        mutant, reason = entry.get("mutant"), entry.get("reason")
        if not isinstance(mutant, str) or not isinstance(reason, str) or not reason.strip():
            raise ExerciseError(file, f"an entry is {entry}", 'Give each a mutant = "…" and a reason = "…".')
        reasons[mutant] = reason
    return reasons


def stale(exercise: Exercise, reasons: dict[str, str], fates: dict[str, Fate]) -> list[Problem]:
    """The entries that hold no longer."""
    file = survivors_file(exercise)
    lines = file.read_text(encoding="utf-8").splitlines() if reasons else []
    found = []
    for id_ in reasons:
        fate = fates.get(id_, "gone")
        if fate in NOW:
            line = next((i for i, text in enumerate(lines, start=1) if id_ in text), 1)
            told = f"the mutant {id_} is listed as a survivor, but {NOW[fate]}"
            found.append(Problem(f"{file}:{line}", id_, told, "Take the entry out."))
    return found
