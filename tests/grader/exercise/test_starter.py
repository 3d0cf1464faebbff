"""The starter is made from the solution's markers."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

from grader.exercise import load, starter
from grader.exercise.starter import MarkerError

EXERCISES = Path(__file__).parents[3] / "exercises"


def test_what_stands_between_the_marks_is_gone_and_the_rest_stays() -> None:
    source = "a = 1\n# TODO: set b.\n# BEGIN SOLUTION\nb = 2\n# END SOLUTION\nc = 3\n"
    assert starter(source) == "a = 1\n# TODO: set b.\nc = 3\n"


def test_a_body_left_empty_gets_a_pass() -> None:
    source = "def f():\n    # BEGIN SOLUTION\n    return 1\n    # END SOLUTION\n\n\ndef g():\n    return 2\n"
    assert starter(source) == "def f():\n    pass\n\n\ndef g():\n    return 2\n"


def test_two_blocks_in_one_body_leave_one_pass() -> None:
    block = "    # BEGIN SOLUTION\n    x = 1\n    # END SOLUTION\n"
    assert starter(f"def f():\n{block}    # TODO\n{block}").count("pass") == 1


@pytest.mark.parametrize(
    ("source", "line"),
    [
        ("a = 1\n# BEGIN SOLUTION\nb = 2\n", 2),
        ("a = 1\n# END SOLUTION\n", 2),
        ("# BEGIN SOLUTION\n# BEGIN SOLUTION\n", 2),
        ("a = 1\n", 1),
    ],
)
def test_markers_that_do_not_pair_up_are_reported_with_their_line(source: str, line: int) -> None:
    with pytest.raises(MarkerError) as caught:
        starter(source)
    assert caught.value.line == line


FOLDERS = sorted(path.parent for path in EXERCISES.glob("*/exercise.toml"))


@pytest.mark.usefixtures("course_interfaces")
@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: str(folder.name))
def test_the_starter_of_every_exercise_is_python_with_todos_and_no_solution(folder: Path) -> None:
    exercise = load(folder)
    assert exercise.solution_file
    text = starter(exercise.solution_file.read_text(encoding="utf-8"))
    ast.parse(text)
    assert "# TODO" in text
    assert "SOLUTION" not in text
