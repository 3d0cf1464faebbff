"""`spinbook audit --shadow` grades every file of the solutions over both middlewares, and lists what differs."""

from __future__ import annotations

from pathlib import Path

import pytest
from click.testing import CliRunner, Result
from small_exercise import SmallExercise

from grader.audit.command import audit
from grader.sandbox import Middleware, choose_middleware

pytestmark = pytest.mark.skipif(
    choose_middleware().middleware is not Middleware.LOCKSTEP, reason=choose_middleware().warning
)


def run(*arguments: str) -> Result:
    return CliRunner().invoke(audit, [*arguments], catch_exceptions=False)


#: The remaining mistakes: one that a check misses a part of, one that ends badly, one that prints too much.
MISTAKES = {"says_nothing", "no_end", "twice"}


@pytest.fixture(autouse=True)
def in_the_course(small: SmallExercise, cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Start in the small exercise's course, with a few of its mistakes: runs over Fast DDS take real time."""
    for file in (small.course / "solutions" / "doubler" / "mistakes").glob("*.py"):
        if file.stem not in MISTAKES:
            file.unlink()
    monkeypatch.chdir(small.course)


def test_where_both_agree_it_ends_with_0(small: SmallExercise) -> None:
    done = run("--shadow")

    assert done.exit_code == 0, done.stdout
    programs = len(list((small.course / "solutions" / "doubler").rglob("*.py")))
    assert f"{programs} programs over both middlewares: 0 of" in done.stdout


def test_each_verdict_that_differs_is_listed_with_the_reason(small: SmallExercise) -> None:
    solution = small.course / "solutions" / "doubler" / "solution.py"
    right = solution.with_name("right")
    right.mkdir(exist_ok=True)
    # Over Fast DDS a node has a network.
    (right / "has_a_network.py").write_text("import socket\n\nsocket.socket(socket.AF_INET)\n" + solution.read_text())

    # The grader finds this node before there is the other one, and yet names both.
    second = "    import time\n\n    rclpy.create_node('never_spun')\n    time.sleep(0.5)\n    try:\n"
    (right / "has_a_second_node.py").write_text(solution.read_text().replace("    try:\n", second, 1))

    done = run("doubler", "--shadow")

    assert done.exit_code == 1, done.stdout
    text = " ".join(done.stdout.split())
    assert "≠ right/has_a_network.py, outcome lockstep did-not-start:" in text
    assert "A node has no network while it is graded" in text
    assert "fastdds graded" in text
    assert "its run is did-not-start over lockstep, completed over Fast DDS" in text
    assert "its run is completed over lockstep, timed-out over Fast DDS" in text
    assert "a node that the program creates but never spins does not answer" in text
    assert "no reason is known" not in text


def test_it_goes_with_no_other_option() -> None:
    done = run("--shadow", "--quick")

    assert done.exit_code == 2
    assert "--shadow can be combined only with --parallel" in done.output
