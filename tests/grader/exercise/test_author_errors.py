"""What an author has to fix is reported as the author's, with its file, before any student is graded."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest

from grader.exercise import ExerciseError, load
from grader.grading import Options, grading_of
from grader.workers import WorkerPool
from groundwork.problem import Problem

ROOT = Path(__file__).parents[3]


@pytest.fixture
def course(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A copy of the course's exercise and solution, with only its first scenarios and less in them, to spoil."""
    monkeypatch.setenv("SPINBOOK_CACHE", str(tmp_path / "cache"))
    exercise = tmp_path / "exercises" / "small"
    shutil.copytree(ROOT / "exercises" / "joint_velocity", exercise)
    shutil.copytree(ROOT / "solutions" / "joint_velocity", tmp_path / "solutions" / "small")
    (exercise / "hidden_checks.py").write_text('"""None."""\n')
    scenarios = (exercise / "scenarios.py").read_text(encoding="utf-8")
    short = scenarios.replace("arm_swing(10)", "arm_swing(1)").replace(
        "in streams.items()", "in list(streams.items())[:2]"
    )
    (exercise / "scenarios.py").write_text(short)
    toml = (exercise / "exercise.toml").read_text(encoding="utf-8")
    (exercise / "exercise.toml").write_text(toml.replace("points = 100", "points = 41"))
    return tmp_path


def change(file: Path, old: str, new: str) -> None:
    text = file.read_text(encoding="utf-8")
    assert old in text
    file.write_text(text.replace(old, new, 1), encoding="utf-8")


def problem_of(course: Path, workers: WorkerPool) -> Problem:
    with pytest.raises(ExerciseError) as caught:
        grading_of(load(course / "exercises" / "small"), Options(), workers)
    return caught.value.problem


def test_unspoiled_it_is_ready(course: Path, workers: WorkerPool) -> None:
    assert grading_of(load(course / "exercises" / "small"), Options(), workers).references["chapter"].received


def test_a_missing_solution(course: Path, workers: WorkerPool) -> None:
    (course / "solutions" / "small" / "solution.py").unlink()
    assert problem_of(course, workers).file.name == "solution.py"


@pytest.mark.parametrize(
    ("file", "old", "new", "message"),
    [
        ("exercise.toml", "points = 41", "points = 40",
         r"give 41 points together \(checks.py 41, hidden_checks.py 0\), but points = 40"),
        ("checks.py", "chapter.must_answer()", "assert False, 'never right'", "solution does not pass.*never right"),
        ("checks.py", "chapter.must_answer()", "chapter.must_anser()",
         r"breaks.*checks\.py:\d+: AttributeError.*Did you mean must_answer\?"),
        ("checks.py", "def test_answers_each_message_once(chapter", "def test_a(no_scenario",
         "asks for the scenario no_scenario"),
        ("checks.py", "def test_answers_at_once", "def test_answers_each_message_once",
         "two checks called test_answers_each_message_once"),
        ("checks.py", "points=4,", "points='4',", "gives '4' points"),
        ("checks.py", "points=4,", "points=4, misconception=3,", "the misconception of .* is 3"),
        ("checks.py", '    """It publishes one message for each message after the first."""\n', "", "no docstring"),
        ("checks.py", "from grader.checking import Run, check", "import no_such_module", "no_such_module"),
        ("checks.py", "depends=[test_publishes_velocities]", "depends=['test_later']", "test_later"),
        ("checks.py", "def test_answers_each", "def answers_each", "begins with test_: call it test_answers_each"),
        ("checks.py", "@check(points=3,", "def test_bare(chapter: Run) -> None: ...\n\n\n@check(points=3,",
         "test_bare is not a check"),
        ("scenarios.py", "arm_swing(1)", "arm_wing(1)", "arm_wing"),
        ("exercise.toml", 'topic = "/joint_commands"', 'topic = "joint_commands"', "joint_commands"),
    ],
    ids=["points", "fails", "breaks", "fixture", "twice", "text", "hint", "title", "import", "depends", "name", "mark",
         "scenario", "topic"],
)  # fmt: skip
def test_what_is_wrong_is_reported_with_its_file(
    course: Path, workers: WorkerPool, file: str, old: str, new: str, message: str
) -> None:
    change(course / "exercises" / "small" / file, old, new)
    problem = problem_of(course, workers)
    assert problem.file.name == file
    assert re.search(message, problem.problem), problem.problem
    assert problem.fix


@pytest.mark.parametrize("broken", ["def test_(:\n", "no_such_name\n", "import no_such_module\n"])
def test_checks_that_can_not_be_imported_are_reported_with_their_line(
    course: Path, workers: WorkerPool, broken: str
) -> None:
    file = course / "exercises" / "small" / "checks.py"
    lines = file.read_text(encoding="utf-8").count("\n")
    with file.open("a", encoding="utf-8") as checks:
        checks.write(broken)
    problem = problem_of(course, workers)
    assert (problem.file, problem.line) == (file, lines + 1)


def test_a_solution_that_crashes(course: Path, workers: WorkerPool) -> None:
    change(course / "solutions" / "small" / "solution.py", "if math.isfinite(position)", "if math.no(position)")
    problem = problem_of(course, workers)
    assert problem.file.name == "solution.py"
    assert "AttributeError" in problem.problem
    assert problem.line
