"""The same exercise as a course of nbgrader's and as an assignment of otter-grader's."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

from grader.checking import Run
from grader.grading.grading import Grading
from grader.scenario.scenario import SECOND, START

HERE = Path(__file__).parent
ASSIGNMENT = "joint_velocity"


def lay_scenarios(grading: Grading, folder: Path) -> float:
    """Write real_time.py and scenarios.json into `folder`; how many seconds all scenarios last together."""
    runner = grading.runner
    data: dict[str, Any] = {}
    for scenario in runner.scenarios:
        run = Run(runner.exercise, grading.references[scenario.name], grading.references[scenario.name])
        data[scenario.name] = {
            "messages": [{"at": (m.at - START) / SECOND, "fields": m.fields} for m in scenario.messages],
            "expected": [message.by("name", "velocity") for message in run.received],
        }
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "scenarios.json").write_text(json.dumps(data), encoding="utf-8")
    shutil.copy(HERE / "real_time.py", folder)
    return sum(scenario.seconds for scenario in runner.scenarios)


def nbgrader_course(folder: Path, names: list[str], lib: Path) -> Path:
    """A course with one assignment, a test cell a scenario; returns the source notebook."""
    source = folder / "source" / ASSIGNMENT / f"{ASSIGNMENT}.ipynb"
    cells = [_cell("answer", "### BEGIN SOLUTION\n### END SOLUTION", solution=True)]
    for name in names:
        code = f"import sys\nsys.path.insert(0, {str(lib)!r})\nimport real_time\n"
        code += f"assert real_time.play(JointVelocity, {name!r})"
        cells.append(_cell(name, code, grade=True, points=1))
    source.parent.mkdir(parents=True)
    source.write_text(_notebook(cells), encoding="utf-8")
    (folder / "nbgrader_config.py").write_text(
        f'c = get_config()\nc.CourseDirectory.root = {str(folder)!r}\nc.CourseDirectory.course_id = "c"\n'
        "c.ExecutePreprocessor.timeout = 900\nc.Execute.timeout = 900\n",
        encoding="utf-8",
    )
    return source


def hand_in_nbgrader(folder: Path, student: str, code: str) -> None:
    """Put a student's code into a copy of the released notebook."""
    released = json.loads((folder / "release" / ASSIGNMENT / f"{ASSIGNMENT}.ipynb").read_text(encoding="utf-8"))
    next(cell for cell in released["cells"] if cell["metadata"]["nbgrader"]["solution"])["source"] = code
    submitted = folder / "submitted" / student / ASSIGNMENT / f"{ASSIGNMENT}.ipynb"
    submitted.parent.mkdir(parents=True)
    submitted.write_text(json.dumps(released), encoding="utf-8")


def otter_tests(folder: Path, names: list[str], lib: Path) -> None:
    """A test file a scenario, in otter's OK format."""
    (folder / "tests").mkdir(parents=True)
    for name in names:
        code = (
            f">>> import sys\n>>> sys.path.insert(0, {str(lib)!r})\n>>> import real_time\n"
            f">>> real_time.play(JointVelocity, {name!r})\nTrue"
        )
        test = {"name": name, "points": 1, "suites": [{"cases": [{"code": code, "hidden": False}], "type": "doctest"}]}
        (folder / "tests" / f"{name}.py").write_text(f"OK_FORMAT = True\n\ntest = {test!r}\n", encoding="utf-8")


def hand_in_otter(folder: Path, student: str, code: str) -> Path:
    """A student's notebook."""
    notebook = folder / f"{student}.ipynb"
    cell: dict[str, Any] = {"cell_type": "code", "id": "answer", "metadata": {}, "source": code}
    cell |= {"outputs": [], "execution_count": None}
    notebook.write_text(_notebook([cell]), encoding="utf-8")
    return notebook


def _cell(name: str, code: str, grade: bool = False, solution: bool = False, points: int = 0) -> dict[str, Any]:
    data: dict[str, Any] = {"grade_id": name, "grade": grade, "solution": solution, "locked": grade, "task": False}
    data |= {"schema_version": 3, **({"points": points} if grade else {})}
    metadata = {"nbgrader": data}
    return {
        "cell_type": "code",
        "id": name,
        "metadata": metadata,
        "source": code,
        "outputs": [],
        "execution_count": None,
    }


def _notebook(cells: list[dict[str, Any]]) -> str:
    kernel = {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}}
    return json.dumps({"cells": cells, "metadata": kernel, "nbformat": 4, "nbformat_minor": 5})
