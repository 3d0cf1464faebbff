"""`spinbook grade` prints what is right and wrong, and ends with 0, 1, 2 or 3."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from prepared_python import run_prepared

ROOT = Path(__file__).parents[2]
SOLUTIONS = ROOT / "solutions" / "joint_velocity"


def grade(*arguments: str, cwd: Path = ROOT, **environment: str) -> subprocess.CompletedProcess[str]:
    return run_prepared("grader", *arguments, cwd=cwd, env={**os.environ, **environment})


def test_a_mistake_is_reported_with_when_and_where_drawn_and_recorded(tmp_path: Path) -> None:
    done = grade(
        "joint_velocity", "--mistake", "joints_by_index",
        "--plot", str(tmp_path / "out.svg"), "--bag", str(tmp_path / "bags"), "--verbose",
    )  # fmt: skip
    assert (done.returncode, done.stderr) == (1, "")
    text = " ".join(done.stdout.split())
    for message in (
        "90 of 100 points",
        "Message 2 of 20 (0.10 s",
        "left_shoulder_roll",
        "expected velocity",
        "Where to look:",
    ):
        assert message in text
    svg = (tmp_path / "out.svg").read_text()
    assert "first wrong" in svg
    assert all(joint in svg for joint in ("left_elbow", "right_shoulder_pitch"))
    assert (tmp_path / "bags" / "reordered" / "metadata.yaml").exists()


def test_where_the_first_scenario_decides_the_others_leave_nothing_among_temporary_files(
    temporary_files: Path, tmp_path: Path
) -> None:
    never = tmp_path / "never_creates_a_node.py"
    never.write_text("print('Hello, world!')\n")
    command = [sys.executable, "-m", "grader", "joint_velocity", str(never)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, check=False)
    assert (done.returncode, done.stderr) == (1, b"")
    assert list(temporary_files.iterdir()) == []


@pytest.mark.parametrize("arguments", [
    ["no_exercise", "x.py"], ["joint_velocity", "nowhere.py"], ["joint_velocity"],
    ["joint_velocity", "--mistake", "fixed_dt", "--plot", "picture.png"],
])  # fmt: skip
def test_wrong_usage_ends_with_2_and_says_what_is_right(arguments: list[str]) -> None:
    done = grade(*arguments)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    assert "Usage:" in done.stderr


def test_one_program_with_the_results_folder_of_a_class_is_refused_with_what_to_do(tmp_path: Path) -> None:
    done = grade("joint_velocity", str(SOLUTIONS / "solution.py"), "--out", str(tmp_path / "results"))
    assert done.returncode == 2
    assert "Leave out --out" in done.stderr
    assert not (tmp_path / "results").exists()


@pytest.mark.parametrize("out", [".", "results", "anna/results"])
def test_results_among_the_submissions_would_be_read_as_a_students_and_are_refused(out: str, tmp_path: Path) -> None:
    (tmp_path / "anna").mkdir()
    done = grade("joint_velocity", str(tmp_path), "--out", str(tmp_path / out))
    assert done.returncode == 2
    assert "Give a folder outside of the submissions." in " ".join(done.stderr.split())


def test_an_authors_fault_ends_with_3(tmp_path: Path) -> None:
    folder = tmp_path / "exercises" / "lonely"
    folder.mkdir(parents=True)
    for file in (ROOT / "exercises" / "joint_velocity").iterdir():
        if file.is_file():
            (folder / file.name).write_bytes(file.read_bytes())
    done = grade("lonely", str(SOLUTIONS / "solution.py"), cwd=tmp_path)
    assert done.returncode == 3
    assert "solution.py: there is no such file" in done.stderr
    assert "not the submission" in done.stderr
    assert "Traceback" not in done.stderr


def test_the_executable_of_an_installed_package_is_graded_with_the_modules_beside_it(tmp_path: Path) -> None:
    prefix = tmp_path / "install" / "vel"
    script = prefix / "lib" / "vel" / "heartbeat"
    modules = prefix / "lib" / "python3.11" / "site-packages" / "vel"
    for folder in (script.parent, modules):
        folder.mkdir(parents=True)
    script.write_text("#!/usr/bin/env python3\nfrom vel.heartbeat import main\nmain()\n")
    (modules / "__init__.py").write_text("")
    (modules / "heartbeat.py").write_bytes((ROOT / "solutions" / "heartbeat" / "solution.py").read_bytes())
    done = grade("heartbeat", "vel/heartbeat", "--json", AMENT_PREFIX_PATH=str(prefix))
    assert done.returncode == 0, done.stdout + done.stderr
    entries = json.loads(done.stdout)
    assert (entries["outcome"], entries["score"], entries["points"]) == ("graded", 50, 50)
    assert entries["isolation"] in ("bubblewrap", "namespaces", "landlock")
    assert len(entries["digest"]) == 64
    assert all(verdict["status"] == "passed" for verdict in entries["verdicts"])
