"""What students get of an exercise and of a chapter's notebook: no solution, no hidden checks, no comments."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any
from urllib.parse import unquote

from grader.exercise.data_files import data_files
from grader.exercise.exercise import Exercise, ExerciseError
from grader.exercise.loading import load
from grader.exercise.modules import error_in
from grader.exercise.starter import starter
from grader.exercise.writing import to_toml
from grader.grading.grade import Options
from grader.grading.public import modules_of, public_part, to_json
from grader.sandbox.isolation import choose
from grader.sandbox.program import Isolation, SandboxUnavailable
from grader.scenario.store import code_in
from grader.workers.jobs import JudgeJob
from grader.workers.pool import WorkerPool
from spinbook.chapter.comments import without_comments
from spinbook.chapter.links import linked


def exercise_files(exercise: Exercise, workers: WorkerPool) -> dict[str, bytes]:
    """Return the copy's files by name: task, starter, public checks, and the data that these need.

    Runs the author's solution through the public scenarios, unless that was done before, and tries the copy: its checks
    must pass with it. Raises `ExerciseError`.
    """
    solution = exercise.solution_file
    assert solution
    public = public_part(exercise, Options(), _isolation(), workers)
    files = {
        "task.md": without_comments(exercise.task).encode(),
        "exercise.toml": to_toml(exercise).encode(),
        "checks.py": (exercise.folder / "checks.py").read_bytes(),
        exercise.public_file.name: to_json(exercise, public).encode(),
        **{file.name: file.read_bytes() for file in modules_of(exercise, public)},
        exercise.file_name: starter(solution.read_text(encoding="utf-8")).encode(),
        **data_files(exercise),
        **{str(name): (exercise.folder / name).read_bytes() for name in _pictures(exercise)},
    }
    _try(exercise, files, workers)
    return files


def _try(exercise: Exercise, files: Mapping[str, bytes], workers: WorkerPool) -> None:
    """Raise `ExerciseError` unless the checks pass on the solution's recordings in a folder with only these files."""
    with tempfile.TemporaryDirectory(prefix="spinbook-copy-") as folder:
        copy = Path(folder).resolve() / "exercises" / exercise.name
        for name, content in files.items():
            (copy / name).parent.mkdir(parents=True, exist_ok=True)
            (copy / name).write_bytes(content)
        try:
            _try_copy(load(copy).public(), workers)
        except ExerciseError as error:
            where = error.problem
            problem = f"in the students' copy, {where.problem}"
            raise ExerciseError(exercise.folder / where.file.name, problem, where.fix, where.line) from None


def _try_copy(copy: Exercise, workers: WorkerPool) -> None:
    public = public_part(copy, Options(), Isolation.NONE, workers)
    for scenario in public.scenarios:
        for code in code_in(scenario):
            try:
                code.load()
            except Exception as error:
                raise error_in(error, copy.folder, Path(code.file), fix=_FIX) from None
    titles = {scenario.name: scenario.title for scenario in public.scenarios}
    for verdict in workers.judge(JudgeJob(copy, public.references, public.references, titles, Options().seed)):
        if verdict.status != "passed":
            problem = f"{verdict.name} breaks: {verdict.error.replace(f'{copy.folder}/', '')}"
            raise ExerciseError(copy.folder / "checks.py", problem, _FIX)


_FIX = "Everything that it needs must be in files that it imports, next to it, and in none that are hidden."


def _isolation() -> Isolation:
    try:
        return choose()
    except SandboxUnavailable:
        # The solution belongs to the author.
        return Isolation.NONE


def _pictures(exercise: Exercise) -> Iterator[Path]:
    """Yield the pictures next to the task that it shows."""
    shown: set[str] = set()
    linked(exercise.task, lambda target, _: shown.add(unquote(target)))
    for file in sorted(exercise.folder.rglob("*")):
        name = file.relative_to(exercise.folder)
        if file.suffix in (".png", ".svg", ".jpg", ".jpeg", ".gif") and name.as_posix() in shown:
            yield name


#: The metadata of a notebook, and of a cell, that students get. Anything an editor has added is left out.
_NOTEBOOK_KEYS = ("kernelspec", "language_info", "spinbook", "title")
_CELL_KEYS = ("spinbook", "tags")

_HELP = """\
# It says "No module named 'spinbook'"? Choose the handout's .venv as this notebook's kernel,
# or do step 1 of README.md. In Colab: README.md says how.
"""


def for_students(notebook: str, repository: str) -> str:
    """Return a notebook without outputs and authors' comments; links to a task lead to the copy next to it."""
    entries: dict[str, Any] = json.loads(notebook)
    away = f"{repository}/blob/main/" if repository else "../"
    entries["metadata"] = {key: entries["metadata"][key] for key in _NOTEBOOK_KEYS if key in entries["metadata"]}
    for cell in entries["cells"]:
        cell["metadata"] = {key: cell["metadata"][key] for key in _CELL_KEYS if key in cell["metadata"]}
        if cell["cell_type"] == "markdown":
            cell["source"] = linked(without_comments(cell["source"]), lambda target, _: _beside(target, away))
        else:
            cell["outputs"], cell["execution_count"] = [], None
            if cell["metadata"].get("spinbook", {}).get("kind") == "setup":
                cell["source"] = cell["source"].replace("%load_ext", f"{_HELP}%load_ext", 1)
    return json.dumps(entries, ensure_ascii=False, indent=1, sort_keys=True) + "\n"


def _beside(target: str, away: str) -> str | None:
    """Return the target of a link to a task in the handout; None for any other link."""
    name = target.removeprefix(away)
    is_task = name.startswith("exercises/") and name.partition("#")[0].endswith("/task.md")
    return name if name != target and is_task else None
