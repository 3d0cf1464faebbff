"""Checks the code in the editor with the public checks of an exercise.

This is a preview in the page; only the grader grades.
"""

from __future__ import annotations

import ast
import json
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from grader.checking.ending_message import message_of
from grader.checking.verdict import Verdict
from grader.exercise.data_files import LACKS
from grader.exercise.exercise import Exercise
from grader.exercise.loading import load
from grader.recording.arrays import read_arrays
from grader.recording.printed_paths import with_own_frames
from grader.recording.recording import Ending, Recording, from_plain, not_run_because
from grader.report.checks import ShownCheck, public_total, shown_verdicts
from grader.scenario.scenario import Scenario
from grader.scenario.store import from_plain as scenario_from_plain
from spinbook.browser.in_page import runner
from spinbook.browser.in_page.runner import ProgramText

_ARCHIVE = Path("/check.zip")
_FOLDER = Path("/exercises")
_CANNOT = {
    "numpy": "Your program imports numpy, which a web page does not have. Check it in the notebook.",
    "asyncio": "Your program uses asyncio, which needs the browser for itself. Check it in the notebook.",
    "multiprocessing": "Your program starts processes, which a web page can't. Check it in the notebook.",
}
_SEVERAL_FILES = "A web page can't check a program of several files. Check it with `spinbook check`."
_SEVERAL = "This exercise has several programs, which a web page can't check together. Check it in the notebook."


def check(name: str, source: str) -> dict[str, Any]:
    """Return the results of the public checks: `problem` alone, or `total`, `full`, `rows` and more."""
    hindrance = hindrance_of(source)
    if hindrance:
        return {"problem": hindrance}
    exercise = load(unpacked(name)).public()
    scenarios, references, hidden = public_part(exercise)
    if exercise.programs or any(scenario.companions or scenario.programs for scenario in scenarios):
        return {"problem": _SEVERAL}
    if (lacks := exercise.folder / LACKS).exists():
        return {"problem": lacks.read_text()}
    recordings = record(exercise, scenarios, ProgramText(exercise.file_name, source))
    judged = CheckedProgram(verdicts(exercise, scenarios, recordings, references), recordings, references)
    return shown(exercise, judged, hidden)


def read(name: str, file: str, content: memoryview) -> dict[str, Any]:
    """Return the program in a file, for the editor: `source` and `notes`, or `problem` alone."""
    from grader.submission.code import code_of, uses_other_files
    from grader.submission.problems import AmbiguousProgram, Unreadable

    try:
        code = code_of(file, bytes(content), load(unpacked(name)))
    except (Unreadable, AmbiguousProgram) as error:
        return {"problem": str(error)}
    if uses_other_files(code):
        return {"problem": f"{_SEVERAL_FILES} {' '.join(code.notes)}".strip()}
    return {"source": code.source.lstrip("\n"), "notes": code.notes}


def hindrance_of(source: str) -> str:
    """Return why this program can't be checked in a page, in one sentence; "" if it can."""
    try:
        tree = ast.parse(source)
    except (SyntaxError, ValueError):
        return ""  # the run reports the error with its line
    for node in ast.walk(tree):
        for name in _imported(node):
            if name in _CANNOT:
                return _CANNOT[name]
    return ""


def _imported(node: ast.AST) -> list[str]:
    if isinstance(node, ast.Import):
        return [item.name.partition(".")[0] for item in node.names]
    return [(node.module or "").partition(".")[0]] if isinstance(node, ast.ImportFrom) else []


def unpacked(name: str) -> Path:
    """Return the folder of an exercise's public part."""
    folder = _FOLDER / name
    if not folder.is_dir():
        with zipfile.ZipFile(_ARCHIVE) as archive:
            archive.extractall("/", [item for item in archive.namelist() if item.startswith(f"exercises/{name}/")])
    return folder


def public_part(exercise: Exercise) -> tuple[list[Scenario], dict[str, Recording], dict[str, Any]]:
    """Return the scenarios, the solution's recordings of them, and the counts of hidden checks, from public.json."""
    entries = json.loads(exercise.public_file.read_text(encoding="utf-8"), object_hook=read_arrays())
    scenarios = list(scenario_from_plain(entries["scenarios"], exercise.folder))
    return scenarios, from_plain(entries["expected"]), entries["hidden"]


def record(exercise: Exercise, scenarios: list[Scenario], program: ProgramText) -> dict[str, Recording]:
    """Run the program through each scenario; the first decides whether it works at all, as in the grader."""
    first, *others = scenarios
    found = {first.name: runner.run(exercise, first, program)}
    works = found[first.name].ending.outcome == "completed"
    for scenario in others:
        found[scenario.name] = (
            runner.run(exercise, scenario, program) if works else not_run_because(found[first.name], scenario.name)
        )
    return found


def verdicts(
    exercise: Exercise, scenarios: list[Scenario], recordings: dict[str, Recording], references: dict[str, Recording]
) -> tuple[Verdict, ...]:
    """Return the checks' verdicts."""
    from grader.checking.judge import judge, runs_of

    titles = {scenario.name: scenario.title for scenario in scenarios}
    return judge(exercise, runs_of(exercise, recordings, references, titles))


@dataclass(frozen=True)
class CheckedProgram:
    """What the checks say of one program: the part of a `Grade` that is shown, which itself needs a sandbox."""

    verdicts: tuple[Verdict, ...]
    recordings: dict[str, Recording]
    references: dict[str, Recording]

    @property
    def ending(self) -> Ending:
        """How the program ended in the first scenario."""
        return next(iter(self.recordings.values())).ending

    @property
    def outcome(self) -> str:
        """The outcome, as in a grade."""
        return "graded" if self.ending.outcome == "completed" else self.ending.outcome

    @property
    def line(self) -> int | None:
        """The line that is to blame, if it is known."""
        return self.ending.line

    @property
    def log(self) -> str:
        """What the program printed in the first scenario, without the frames of libraries."""
        return with_own_frames(next(iter(self.recordings.values())).log)

    @property
    def full_marks(self) -> bool:
        """Whether all checks passed."""
        return all(verdict.status == "passed" for verdict in self.verdicts)


def shown(exercise: Exercise, judged: Any, hidden: dict[str, Any]) -> dict[str, Any]:
    """Return the result in the page's form: what the notebook's `%check` shows. `judged` is a `CheckedProgram`."""
    from grader.report.facts import plot_says
    from grader.report.feedback import advice
    from grader.report.feedback_plot import picture

    broken = next((r for r in judged.recordings.values() if r.ending.outcome != "completed"), None)
    checks = shown_verdicts(judged.verdicts, telling=judged.outcome == "graded", self_check=True)
    advised = advice(judged, exercise)
    plot = picture(judged, exercise) or ""
    return {
        "total": public_total(judged.verdicts),
        "full": judged.full_marks,
        "message": message_of(broken.ending, exercise) if broken else "",
        "step": advised.steps[0] if advised else "",
        "log": judged.log.strip()[-4000:],
        "hidden": hidden,
        "rows": [_row(check, exercise, judged.recordings) for check in checks],
        "counts_hints": exercise.count_hints,
        "plot": plot,
        "plot_says": plot_says(checks, plot) if plot else "",
    }


def _row(check: ShownCheck, exercise: Exercise, recordings: Mapping[str, Recording]) -> dict[str, Any]:
    """Return a check in the page's form."""
    from grader.report.facts import facts

    table, remark = facts(check.finding, recordings, exercise.element_name) if check.finding else ((), "")
    return {
        "title": check.title,
        "status": "untested" if check.untested else check.status,
        "earned": check.earned,
        "points": check.points,
        "text": remark,
        "facts": table,
        "hints": check.labelled_hints,
        "note": check.note,
    }
