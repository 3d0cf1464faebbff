"""What Gradescope is told, and the autograder that is uploaded there."""

from __future__ import annotations

import json
import os
import stat
import subprocess
import sys
import zipfile
from io import BytesIO
from pathlib import Path

import plain_grades as plain
import pytest
from small_class import EXERCISE, TEMPLATE

from grader.classroom import Adjustment
from grader.exercise import load
from grader.gradescope.bundle import bundle
from grader.gradescope.results import results


def test_public_checks_are_seen_at_once_and_hidden_ones_when_grades_are_published() -> None:
    told = results(plain.entry(plain.HALF))
    assert told["score"] == 6
    assert told["stdout_visibility"] == "hidden"
    public, hidden = told["tests"]
    assert (public["visibility"], public["score"], public["max_score"], public["status"]) == ("visible", 6, 6, "passed")
    assert (hidden["visibility"], hidden["score"], hidden["status"]) == ("after_published", 0, "failed")


def test_of_a_hidden_check_no_name_scenario_or_number_is_told() -> None:
    text = json.dumps(results(plain.entry(plain.HALF)))
    assert "Think of stamps." in text
    for secret in ("test_secret_gap", "31.40", "expected 2.5", '"gap"'):
        assert secret not in text


def test_late_work_counts_there_too() -> None:
    told = results(plain.entry(plain.HALF, adjustments=(Adjustment("late", -1.0, "handed in 1 h late"),)))
    assert told["score"] == 5
    assert "-1 points: handed in 1 h late" in told["output"]


def test_a_fault_of_ours_has_no_score() -> None:
    told = results(plain.entry(plain.FAULT))
    assert "score" not in told
    assert "tests" not in told
    assert "not your fault" in told["output"]


@pytest.fixture(scope="module")
def autograder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder /autograder of a container, with the uploaded zip unpacked in it and this environment as its own."""
    root = tmp_path_factory.mktemp("autograder")
    with zipfile.ZipFile(BytesIO(bundle(load(TEMPLATE / "exercises" / EXERCISE)))) as archive:
        archive.extractall(root / "source")
        for entry in archive.infolist():
            os.chmod(root / "source" / entry.filename, stat.S_IMODE(entry.external_attr >> 16))  # noqa: PTH101
    (root / "source" / "venv").symlink_to(sys.prefix)
    (root / "submission").mkdir()
    (root / "run_autograder").write_bytes((root / "source" / "run_autograder").read_bytes())
    return root


def graded(root: Path, source: str) -> dict[str, object]:
    """What run_autograder writes for a submission."""
    (root / "submission" / "my node.py").write_text(source, encoding="utf-8")
    (root / "submission_metadata.json").write_text(
        json.dumps({"created_at": "2026-11-20T23:41:07.000000-08:00", "users": [{"id": 7, "name": "Ada"}]})
    )
    subprocess.run(["bash", str(root / "run_autograder")], check=True, timeout=280, stdout=subprocess.DEVNULL)
    told: dict[str, object] = json.loads((root / "results" / "results.json").read_text(encoding="utf-8"))
    return told


def test_the_zip_holds_the_two_scripts_and_of_the_solutions_only_one(autograder: Path) -> None:
    source = autograder / "source"
    for script in ("setup.sh", "run_autograder"):
        assert os.access(source / script, os.X_OK)
        assert subprocess.run(["bash", "-n", str(source / script)], check=False).returncode == 0
    solutions = [file.name for file in (source / "course" / "solutions").rglob("*") if file.is_file()]
    assert solutions == ["solution.py"]


def test_the_zip_holds_what_compiles_messages_and_the_courses_own_definitions(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    definition = tmp_path / "prefix" / "definitions" / "arm_msgs" / "msg" / "Joint.msg"
    definition.parent.mkdir(parents=True)
    definition.write_text("string name\n")
    monkeypatch.setenv("SPINBOOK_INTERFACES", str(tmp_path / "prefix"))
    with zipfile.ZipFile(BytesIO(bundle(load(TEMPLATE / "exercises" / EXERCISE)))) as archive:
        names = archive.namelist()
    assert "course/interfaces/arm_msgs/msg/Joint.msg" in names
    assert "course/interface_compiler/definitions/standard/turtlesim/msg/Pose.msg" in names
    assert "course/course.toml" in names


def test_the_same_content_makes_the_same_zip() -> None:
    exercise = load(TEMPLATE / "exercises" / EXERCISE)
    assert bundle(exercise) == bundle(exercise)


def test_the_autograder_grades_what_was_uploaded(autograder: Path) -> None:
    right = (TEMPLATE / "solutions" / EXERCISE / "solution.py").read_text(encoding="utf-8")
    assert graded(autograder, right)["score"] == 20
    assert graded(autograder, "import rclpy\nrclpy.spin(\n")["score"] == 0


def test_an_autograder_that_is_broken_gives_no_score(autograder: Path) -> None:
    checks = autograder / "source" / "course" / "exercises" / EXERCISE / "exercise.toml"
    text = checks.read_text(encoding="utf-8")
    checks.write_text("points = ", encoding="utf-8")
    try:
        told = graded(autograder, "pass\n")
    finally:
        checks.write_text(text, encoding="utf-8")
    assert "score" not in told
    assert "not your fault" in str(told["output"])
