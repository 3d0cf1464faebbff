"""The part of an exercise that a student may have: public scenarios, and what the solution published in them.

A student's copy of an exercise has neither solution nor scenarios.py nor hidden checks. Its public checks compare with
the recordings in `public.json`, which is made from the author's folders by `public_part` and `to_json`.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from grader.checking.verdict import ListedCheck
from grader.exercise.exercise import Exercise, ExerciseError
from grader.exercise.imported_files import with_modules
from grader.exercise.modules import HIDDEN_FILES, see_that_students_have
from grader.grading.grade import Options
from grader.grading.reference import reference
from grader.grading.scenario_runner import ScenarioRunner
from grader.recording.arrays import read_arrays
from grader.recording.recording import Recording, RecordingEncoder, from_plain
from grader.sandbox.program import Isolation
from grader.scenario.declared import declared
from grader.scenario.scenario import Scenario
from grader.scenario.store import NotForStudents, code_in
from grader.scenario.store import from_plain as from_plain_scenario
from grader.scenario.store import plain as plain_scenario
from grader.workers.jobs import ListJob
from grader.workers.pool import WorkerPool

#: Increase this when older versions can no longer read the file.
FORMAT = 2


@dataclass(frozen=True)
class PublicPart:
    """Public scenarios, the solution's recordings of them by name, and the numbers of hidden checks and points."""

    scenarios: tuple[Scenario, ...]
    references: dict[str, Recording]
    hidden_checks: int
    hidden_points: float


def public_part(exercise: Exercise, options: Options, isolation: Isolation, workers: WorkerPool) -> PublicPart:
    """Return the public part of an exercise: read from a student's copy, or made from the solution if there is one.

    Raises `ExerciseError` if the author, or a student who changed the copy, has something to fix.
    """
    if exercise.solution_folder is None:
        return read_public(exercise)
    every = declared(exercise, options.seed)
    checks: tuple[ListedCheck, ...] = workers.do(ListJob(replace(exercise, public_only=False)))
    used = {name for check in checks if not check.hidden for name in check.scenarios}
    scenarios = tuple(scenario for scenario in every if scenario.name in used)
    if not scenarios:
        problem = "no public check uses a scenario"
        raise ExerciseError(exercise.folder / "checks.py", problem, "Write one: students check their own work with it.")
    references = reference(ScenarioRunner(exercise.public(), scenarios, isolation, options, workers))
    hidden = [check for check in checks if check.hidden]
    return PublicPart(scenarios, references, len(hidden), sum(check.points for check in hidden))


def to_json(exercise: Exercise, public: PublicPart) -> str:
    """Return the text of public.json: the same for the same scenarios and solution, whenever it is made."""
    expected = {name: _timeless(recording) for name, recording in public.references.items()}
    entries = {
        "format": FORMAT,
        "exercise": exercise.name,
        "hidden": {"checks": public.hidden_checks, "points": public.hidden_points},
        "scenarios": [_for_students(exercise, scenario) for scenario in public.scenarios],
        "expected": expected,
    }
    return json.dumps(entries, cls=RecordingEncoder, ensure_ascii=False, separators=(",", ":")) + "\n"


def modules_of(exercise: Exercise, public: PublicPart) -> Iterator[Path]:
    """Yield each of the author's files that the public checks and scenarios need, with what these import.

    Raises `ExerciseError` if one imports a hidden file. `to_json` refuses a scenario that itself needs one.
    """
    codes = {Path(code.file) for scenario in public.scenarios for code in code_in(scenario)}
    code_files = sorted(file for file in codes if file.name not in HIDDEN_FILES)
    files = with_modules([exercise.folder / "checks.py", *code_files])
    see_that_students_have(files)
    yield from sorted(files)


def _timeless(recording: Recording) -> Recording:
    """Return a recording without the solution's log and duration."""
    return replace(recording, log="", seconds=0.0, lockstep_seconds=0.0)


def playable(exercise: Exercise) -> dict[str, Scenario]:
    """Return the scenarios that may be played here, by name: in a student's copy the public ones, for the author all.

    Raises `ExerciseError`.
    """
    scenarios = declared(exercise, seed=1) if exercise.solution_folder else read_public(exercise).scenarios
    return {scenario.name: scenario for scenario in scenarios}


def read_public(exercise: Exercise) -> PublicPart:
    """Return the public part that a student's copy has. Raises `ExerciseError`."""
    file = exercise.public_file
    fix = "Take it from the course's handout again."
    try:
        entries: dict[str, Any] = json.loads(file.read_text(encoding="utf-8"), object_hook=read_arrays())
        if entries["format"] != FORMAT:
            fix = "Install the spinbook that came with the handout: pip install -r requirements.txt"
            raise ExerciseError(file, f"it has the format {entries['format']}, not {FORMAT}", fix)
        public = PublicPart(
            from_plain_scenario(entries["scenarios"], exercise.folder),
            from_plain(entries["expected"]),
            int(entries["hidden"]["checks"]),
            float(entries["hidden"]["points"]),
        )
        if not all(isinstance(scenario, Scenario) for scenario in public.scenarios):
            raise TypeError("a scenario is something else")
    except FileNotFoundError:
        raise ExerciseError(file, "there is no such file", fix) from None
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise ExerciseError(file, f"it can't be read: {type(error).__name__}: {error}", fix) from None
    if not public.scenarios or any(scenario.name not in public.references for scenario in public.scenarios):
        raise ExerciseError(file, "a scenario or its recording is missing", fix)
    return public


def _for_students(exercise: Exercise, scenario: Scenario) -> Any:
    try:
        return plain_scenario(scenario)
    except NotForStudents as error:
        problem = f"the scenario {scenario.name}, which a public check uses, runs {error} of this file"
        fix = f"Students don't get this file. Put {error} into another one in this folder, or hide the check."
        raise ExerciseError(exercise.scenarios_file, problem, fix, scenario.line or None) from None
