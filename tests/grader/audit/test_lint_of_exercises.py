"""`spinbook lint` checks exercises, too: it reports each fault with file, line and what to do, and runs no node."""

from __future__ import annotations

from pathlib import Path

import pytest
from prepared_python import run_prepared
from small_exercise import SmallExercise

from grader.checking.proofreader import faults, rules_that_the_task_lacks

#: A sentence of the small exercise on which a hidden check is based.
RULE = "Publish nothing on /numbers or /clock."
EXERCISES = Path(__file__).parents[3] / "exercises"

COURSE = """title = "Small"
chapters = ["chapters/one.md"]

[package]
name = "small"
"""


def linted(small: SmallExercise) -> tuple[int, str]:
    """Return the exit code and the output of `spinbook lint` in the exercise's course."""
    (small.course / "course.toml").write_text(COURSE)
    (small.course / "chapters").mkdir()
    (small.course / "chapters" / "one.md").write_text("# One\n\nNothing to run.\n")
    run = run_prepared("spinbook", "lint", cwd=small.course)
    return run.returncode, run.stdout + run.stderr


def test_an_exercise_without_faults(small: SmallExercise) -> None:
    code, output = linted(small)
    assert (code, "0 errors" in output) == (0, True), output


def test_every_fault_is_reported_with_file_and_line(small: SmallExercise) -> None:
    small.change("exercises/doubler/checks.py", "def test_once(", "def test_twice_the_number(")
    small.change("solutions/doubler/mistakes.md", "Caught by: test_twice_the_number", "Caught by: test_no_such_check")
    small.change("solutions/doubler/solution.py", "        # END SOLUTION\n", "")
    code, output = linted(small)
    assert code == 1
    for fault in (
        "exercises/doubler/checks.py:20: error: there are two checks called test_twice_the_number; the other is in lin",
        "solutions/doubler/solution.py:12: error: BEGIN SOLUTION without an END SOLUTION after it",
        "mistakes.md:12: error: adds_two is to be caught by test_no_such_check, and there is no such check",
        "exercises/doubler/exercise.toml:3: error: the checks give 7 points together (checks.py 5, hidden_checks.py 2)",
        "mistakes.md:23: error: twice is to be caught by test_once",
    ):
        assert fault in output, output


def test_a_scenario_that_is_not_there_is_reported_with_those_that_are(small: SmallExercise) -> None:
    small.change("exercises/doubler/hidden_checks.py", "(negative: Run)", "(negativ: Run)")
    code, output = linted(small)
    assert code == 1
    assert "test_nothing_below_zero asks for the scenario negativ, which scenarios.py does not have" in output
    assert "Its scenarios are: positive, negative, any." in output


def test_a_rule_that_the_task_does_not_state_is_reported_with_its_line(small: SmallExercise) -> None:
    hidden = small.course / "exercises" / "doubler" / "hidden_checks.py"
    [line] = [number for number, text in enumerate(hidden.read_text().splitlines(), 1) if RULE in text]
    small.change("exercises/doubler/task.md", "Publish nothing on `/numbers` or `/clock`.", "Quite another sentence.")

    code, output = linted(small)

    assert code == 1
    assert f"hidden_checks.py:{line}: error: a check is based on a sentence that is not in task.md: “{RULE}”" in output


@pytest.mark.parametrize("folder", sorted(EXERCISES.iterdir()), ids=lambda folder: folder.name)
def test_the_task_of_each_exercise_states_the_rules_of_its_checks(folder: Path) -> None:
    task = (folder / "task.md").read_text(encoding="utf-8")
    faults = rules_that_the_task_lacks(task, [folder / "checks.py", folder / "hidden_checks.py"])
    assert [str(fault) for fault in faults] == []


@pytest.mark.parametrize(
    ("file", "old", "new", "place", "fix"),
    [
        ("hidden_checks.py", "check, fail", "check", "hidden_checks.py:19", "from grader.checking import fail"),
        ("checks.py", "positive.nodes != ", "positiv.nodes != ", "checks.py:28", "Did you mean positive?"),
        ("checks.py", 'hint="Multiply.", ', "", "checks.py:13", "points and a hint"),
        ("checks.py", "from grader", "import mazes\nfrom grader", "checks.py:3", "Put mazes.py next to"),
        ("scenarios.py", "    return tuple(", "    every = tuple(", "scenarios.py:9", "return (Scenario(…),)"),
        ("scenarios.py", "def scenarios(", "def all_scenarios(", "scenarios.py", "return (Scenario(…),)"),
        ("scenarios.py", "    chance", '    open("data/map")\n    chance', "scenarios.py:10", "Path(__file__).parent"),
        ("exercise.toml", 'class = "Doubler"', 'class = "Doubling"', "exercise.toml:5", "Make the two agree"),
        ("exercise.toml", "[[publish]]", 'units = { dat = "m" }\n[[publish]]', "exercise.toml:9", "It has: data"),
        ("task.md", "\n", " <!-- rule: a --> Twice. <!-- rule: a -->\n", "task.md:1", "an id of its own"),
        ("checks.py", 'points=1, hint="One', 'points=0, hint="One', "checks.py:20", "Give it points, or leave it out."),
        ("exercise.toml", "points = 10", "points = 10 10", "exercise.toml:3", "as TOML"),
        ("../../solutions/doubler/solution.py", "2 * ", "2 * * ", "solution.py:18", "Fix it"),
    ],
)  # fmt: skip
def test_a_usual_slip_has_its_line_and_its_remedy(
    small: SmallExercise, file: str, old: str, new: str, place: str, fix: str
) -> None:
    small.change(f"exercises/doubler/{file}", old, new)
    problem = next(faults(small.course / "exercises" / "doubler")).problem
    assert problem.place.endswith(place)
    assert fix in problem.fix
