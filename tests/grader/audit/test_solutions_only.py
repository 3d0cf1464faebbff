"""`spinbook audit --solutions` checks whether every file of solutions/ gets the grade that it should."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from small_exercise import SmallExercise

from grader.audit.candidates import IDLE
from grader.audit.command import audit


def solutions_only(*more: str) -> Result:
    return CliRunner().invoke(audit, ["--solutions", *more], catch_exceptions=False)


@pytest.fixture(autouse=True)
def in_the_course(small: SmallExercise, cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Start in the small exercise's course."""
    monkeypatch.chdir(small.course)


def test_without_mutants_it_tells_only_of_the_files(small: SmallExercise) -> None:
    done = solutions_only()
    assert done.exit_code == 0, done.stdout
    assert "tried: 1 right solutions, 7 mistakes, 3 that do nothing\n" in done.stdout
    assert "task.md marks no rules: these are the sentences" in done.stdout
    assert "publishes twice" in done.stdout
    assert "\nnothing to fix\n" in done.stdout


def test_points_for_nothing_end_with_1_and_a_mistake_may_be_a_whole_program_that_names_its_checks(
    small: SmallExercise,
) -> None:
    small.change(
        "exercises/doubler/checks.py", 'hint="Look at the name in __init__.", depends=[test_publishes])', 'hint="x")'
    )
    whole = small.course / "solutions" / "doubler" / "mistakes" / "deaf.py"
    whole.parent.mkdir()
    whole.write_text(
        '"""It does nothing.\n\nCaught by:\n- test_publishes\n"""\nimport rclpy\n' + IDLE.format(name="doubler")
    )
    done = solutions_only("doubler")
    assert done.exit_code == 1
    printed = " ".join(done.stdout.split())
    assert "does nothing passes test_is_called_doubler and gets 1 points" in printed
    assert "8 mistakes" in printed
    assert "mistakes/deaf" not in printed


@pytest.mark.parametrize("other", [("--quick",), ("--mutants", "3"), ("--seeds", "2")])
def test_what_asks_for_something_else_is_refused(other: tuple[str, ...]) -> None:
    done = solutions_only(*other)
    assert done.exit_code == 2
    assert "--solutions tries no mutants and no seeds" in done.stderr
