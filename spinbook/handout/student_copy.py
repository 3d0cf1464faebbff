"""What students get of an exercise and of a chapter's notebook: no solution, no hidden checks, no comments."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from grader.exercise import Exercise, starter
from grader.exercise.writing import to_toml
from grader.grading import Options
from grader.grading.public import modules_of, public_part, to_json
from grader.sandbox import Isolation, SandboxUnavailable, choose
from grader.workers import WorkerPool

_FENCE = re.compile(r"^ {0,3}(`{3,}|~{3,})(.*)$")
#: Code in a line stays, and with it a comment that is only quoted.
_PART = re.compile(r"(?P<code>`+)(?!`).*?(?<!`)(?P=code)(?!`)|<!--(?P<comment>.*?)(?P<end>-->|$)")


def without_comments(markdown: str, *, keep_lines: bool = False) -> str:
    """`markdown` without comments; what stands in code is no comment.

    A line that held nothing else is left out, or, with `keep_lines`, left empty, so that lines keep their numbers.
    """
    out: list[str] = []
    fence = ""
    inside = False
    for line in markdown.split("\n"):
        if inside:
            _, ended, line = line.partition("-->")
            inside = not ended
            if not line.strip():
                out += [""] if keep_lines else []
                continue
        elif match := _FENCE.match(line):
            mark, info = match.groups()
            if not fence:
                fence = mark
            elif mark.startswith(fence) and not info.strip():
                fence = ""
            out.append(line)
            continue
        if fence:
            out.append(line)
            continue
        shown, inside = _shown(line)
        if shown.strip() or not line.strip() or keep_lines:
            out.append(shown)
    return "\n".join(out)


def _shown(line: str) -> tuple[str, bool]:
    """What of a line is shown, and whether a comment goes on in the next."""
    goes_on = False

    def replaced(match: re.Match[str]) -> str:
        nonlocal goes_on
        if match["code"]:
            return match[0]
        goes_on = not match["end"]
        return ""

    return _PART.sub(replaced, line), goes_on


def exercise_files(exercise: Exercise, workers: WorkerPool) -> dict[str, bytes]:
    """The copy's files by name: task, starter, public checks, and what these judge by.

    Spins the author's solution through the public scenarios, unless that was done before. Raises `ExerciseError`.
    """
    solution = exercise.solution_file
    assert solution
    public = public_part(exercise, Options(), _isolation(), workers)
    return {
        "task.md": without_comments(exercise.task).encode(),
        "exercise.toml": to_toml(exercise).encode(),
        "checks.py": (exercise.folder / "checks.py").read_bytes(),
        exercise.public_file.name: to_json(exercise, public).encode(),
        **{file.name: file.read_bytes() for file in modules_of(public)},
        exercise.file_name: starter(solution.read_text(encoding="utf-8")).encode(),
        **{str(name): (exercise.folder / name).read_bytes() for name in _pictures(exercise)},
    }


def _isolation() -> Isolation:
    try:
        return choose()
    except SandboxUnavailable:
        # The solution is the author's own.
        return Isolation.NONE


def _pictures(exercise: Exercise) -> Iterator[Path]:
    """Pictures beside the task that it shows."""
    for file in sorted(exercise.folder.rglob("*")):
        name = file.relative_to(exercise.folder)
        if file.suffix in (".png", ".svg", ".jpg", ".jpeg", ".gif") and f"]({name.as_posix()}" in exercise.task:
            yield name


#: What of a notebook's, and of a cell's, metadata students get. Whatever an editor has added stays behind.
_NOTEBOOK_KEYS = ("kernelspec", "language_info", "spinbook", "title")
_CELL_KEYS = ("spinbook", "tags")

_HELP = """\
# It says "No module named 'spinbook'"? Choose the handout's .venv as this notebook's kernel,
# or do step 1 of README.md. In Colab: README.md tells how.
"""


def for_students(notebook: str, repository: str) -> str:
    """A built notebook without outputs and authors' comments; links to a task lead to the copy beside it."""
    entries: dict[str, Any] = json.loads(notebook)
    away = f"{re.escape(repository)}/blob/main/" if repository else r"\.\./"
    link = re.compile(rf"(\]\(){away}(exercises/\w+/task\.md)")
    entries["metadata"] = {key: entries["metadata"][key] for key in _NOTEBOOK_KEYS if key in entries["metadata"]}
    for cell in entries["cells"]:
        cell["metadata"] = {key: cell["metadata"][key] for key in _CELL_KEYS if key in cell["metadata"]}
        if cell["cell_type"] == "markdown":
            cell["source"] = link.sub(r"\1\2", without_comments(cell["source"]))
        else:
            cell["outputs"], cell["execution_count"] = [], None
            if cell["metadata"].get("spinbook", {}).get("kind") == "setup":
                cell["source"] = cell["source"].replace("%load_ext", f"{_HELP}%load_ext", 1)
    return json.dumps(entries, ensure_ascii=False, indent=1, sort_keys=True) + "\n"
