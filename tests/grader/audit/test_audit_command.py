"""`spinbook audit` prints its findings for people and programs, and ends with 0, 1 or 2."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from browser import opened
from click.testing import CliRunner, Result
from playwright.sync_api import Browser
from process_mark import ProcessMark
from small_exercise import SmallExercise

from grader.audit.command import audit


def run(*arguments: str) -> Result:
    return CliRunner().invoke(audit, [*arguments], catch_exceptions=False)


@pytest.fixture(autouse=True)
def in_the_course(small: SmallExercise, cache: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Start in the small exercise's course."""
    monkeypatch.chdir(small.course)


def test_nothing_to_fix_ends_with_0_and_is_written_as_json_and_as_a_page(small: SmallExercise) -> None:
    done = run("--quick", "--mutants", "6", "--json", "audit.json")
    assert done.exit_code == 0, done.stdout
    assert "nothing to fix" in done.stdout
    (entries,) = json.loads(Path("audit.json").read_text())["audits"]
    assert (entries["exercise"], entries["problems"]) == ("doubler", [])
    assert (entries["score"], entries["caught"] >= 3) == (1, True)
    assert {program["name"]: program["score"] for program in entries["programs"] if program["kind"] != "mistake"} == {
        "solution.py": 10, "the starter": 0, "an empty file": 0, "a node that does nothing": 0,
    }  # fmt: skip
    assert entries["caught"] + entries["equivalent"] == len(entries["mutants"])
    assert {check["name"] for check in entries["checks"]} >= {"test_publishes", "test_nothing_below_zero"}
    assert all(scenario["running_s"] > 0 for scenario in entries["scenarios"])


def test_a_change_that_lets_a_mistake_through_ends_with_1_and_says_which(
    small: SmallExercise, browser: Browser
) -> None:
    small.change("exercises/doubler/hidden_checks.py", "    negative.must_be_silent()\n", "")
    done = run("doubler", "--quick", "--mutants", "2", "--html", "audit.html")
    assert done.exit_code == 1
    text = " ".join(done.stdout.split())
    mistake = "mistakes/any_number (“It doubles negative numbers, too.”)"
    assert f"test_nothing_below_zero lets the mistake {mistake} through" in text
    assert "1 thing to fix" in text
    with opened(browser, Path("audit.html"), width=390, dark=True) as shown:
        for group in shown.page.query_selector_all("details"):
            group.evaluate("group => group.open = true")
        assert "lets the mistake mistakes/any_number" in shown.page.inner_text("main")
        assert shown.faults == []
        assert shown.violations() == []
        assert not shown.scrolls_sideways()


def test_an_exercise_that_can_not_be_audited_ends_with_1_and_says_why(small: SmallExercise) -> None:
    small.change("exercises/doubler/exercise.toml", "points = 10", "points = 11")
    done = run("--quick", "--json", "audit.json")
    assert done.exit_code == 1
    assert "the checks give 10 points together" in done.stderr
    assert "but points = 11" in done.stderr
    assert "exercises/doubler/exercise.toml" in json.loads(Path("audit.json").read_text())["faults"][0]["place"]


@pytest.mark.parametrize(
    ("arguments", "output"),
    [
        (("tripler",), "There are: doubler"),
        (("--no",), "No such option"),
        (("--html", "nowhere/audit.html"), "there is no folder nowhere"),
        (("--json", "exercises"), "that is a folder"),
    ],
)
def test_wrong_usage_ends_with_2(arguments: tuple[str, ...], output: str) -> None:
    done = run(*arguments)
    assert done.exit_code == 2
    assert output in done.stderr


def test_outside_a_course_it_says_where_to_start(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.setattr(Path, "cwd", lambda: Path("/"))
    done = run()
    assert done.exit_code == 2
    assert "Start in a course's folder" in done.stderr


def test_ctrl_c_ends_it_at_once_and_leaves_nothing_running(small: SmallExercise, process_mark: ProcessMark) -> None:
    command = [sys.executable, "-c", "from grader.audit.command import audit; audit()", "--mutants", "4"]
    environment = {**os.environ, "SPINBOOK_CACHE": str(small.course / "cache")}
    running = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment)
    assert running.stderr
    assert "doubler: " in running.stderr.readline(), "it tells how far it is"
    running.send_signal(signal.SIGINT)
    _, output = running.communicate(timeout=120)
    assert running.returncode == 130
    assert "Stopped. The results so far are kept" in output
    assert "Traceback" not in output
    process_mark.wait_until_none()
