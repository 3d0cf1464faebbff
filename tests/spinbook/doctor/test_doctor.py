"""`spinbook doctor` examines everything that a course needs, and reports it to people and to programs."""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner
from rich.console import Console
from running import doctor, finding_of

from ros_in_python.ros2.command import ros2
from spinbook.doctor import command
from spinbook.doctor.copies import link_copies
from spinbook.doctor.diagnosis import CHECKS, MachineCheck, MachineFinding, State, is_able, show


def test_here_everything_that_is_needed_works() -> None:
    run = doctor("--json")
    answer = json.loads(run.stdout)
    states = {finding["name"]: finding["state"] for finding in answer["findings"]}
    assert list(states) == [check.name for check in CHECKS]
    # Whether there is a sandbox depends on the machine that runs the tests; everything else depends on set-up.
    assert [name for name, state in states.items() if state == "missing" and name != "Sandbox"] == []
    message = next(finding["found"] for finding in answer["findings"] if finding["name"] == "A message")
    assert "arrived from another process in" in message
    assert answer["able"] is (states["Sandbox"] != "missing")
    assert run.returncode == (0 if answer["able"] else 1)
    assert run.stderr == ""


def test_a_person_reads_a_line_for_each_check_and_a_sum() -> None:
    run = doctor("folder", "middleware", HOME="/", COLUMNS="1000")
    assert run.returncode == 0
    first, second, *_, last = run.stdout.splitlines()
    assert first.startswith("✓  Folder")
    assert f"(environment: {sys.prefix})" in first
    assert second.startswith("✓  Middleware")
    assert last == "Courses can be built and graded here."


def test_in_a_handout_it_speaks_to_students(tmp_path: Path) -> None:
    (tmp_path / ".spinbook" / "base").mkdir(parents=True)

    assert doctor("folder", folder=tmp_path).stdout.splitlines()[-1] == "Notebooks and checks work here."
    missing = finding_of("ros", folder=tmp_path, PYTHONPATH=os.fspath(tmp_path), ROS_DISTRO="foxy")
    assert "make" not in missing["fix"]


def test_help_names_every_check_and_the_exit_code() -> None:
    text = doctor("--help").stdout
    assert all(check.word in text for check in CHECKS)
    assert "Exit code: 0" in text


def test_copies_of_a_file_become_one_file_and_all_else_is_left_alone(tmp_path: Path) -> None:
    for name, content in (("a.so", b"a"), ("b/a.so.1", b"a"), ("b/other.so", b"b"), ("static/lab.js", b"a")):
        file = tmp_path / name
        file.parent.mkdir(exist_ok=True)
        file.write_bytes(content * 20_000)
    (tmp_path / "small.so").write_bytes(b"a")
    (tmp_path / "link.so").symlink_to("a.so")
    before = {file: (file.read_bytes(), file.is_symlink()) for file in tmp_path.rglob("*.*") if file.is_file()}

    assert link_copies(tmp_path) == 40_000
    assert link_copies(tmp_path) == 0

    assert [(tmp_path / name).stat().st_nlink for name in ("a.so", "b/a.so.1", "static/lab.js", "b/other.so")] == [
        3,
        3,
        3,
        1,
    ]
    assert {file: (file.read_bytes(), file.is_symlink()) for file in tmp_path.rglob("*.*") if file.is_file()} == before


def test_an_environment_that_can_not_be_written_stays_as_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(command, "link_copies", lambda folder: os.link(folder / "no.so", folder / "none" / "no.so"))
    said = CliRunner().invoke(command.doctor, ["--save-space"])
    assert said.exit_code == 1
    assert said.output.startswith(f"Error: {sys.prefix}")
    assert "No such file or directory. Every file is there, as before." in said.output
    assert "run it by itself" in CliRunner().invoke(command.doctor, ["--save-space", "ros"]).output


def test_ros2_doctor_says_whether_ros_works(monkeypatch: pytest.MonkeyPatch) -> None:
    def all_work(checks: list[MachineCheck], done: object) -> list[MachineFinding]:
        return [MachineFinding(check.name, State.OK, "works") for check in checks]

    monkeypatch.setenv("ROS_IN_PYTHON", "own")
    monkeypatch.setattr(command, "diagnose", all_work)
    said = CliRunner().invoke(ros2, ["doctor", "--report"])
    assert said.exit_code == 0, said.output
    assert "A message               : works\n" in said.output
    assert "All 8 checks passed" in said.output


def shown(*findings: MachineFinding) -> str:
    console = Console(width=100, color_system=None, highlight=False)
    with console.capture() as captured:
        show(console, findings)
    return captured.get()


def test_what_is_missing_makes_it_unable_and_a_warning_does_not() -> None:
    assert is_able(
        [MachineFinding("One", State.OK, "works"), MachineFinding("Two", State.WARNING, "is odd", "do this")]
    )
    assert not is_able(
        [MachineFinding("One", State.OK, "works"), MachineFinding("Two", State.MISSING, "is not there", "do that")]
    )


def test_the_fixes_follow_the_list_each_with_its_name() -> None:
    text = shown(
        MachineFinding("One", State.OK, "works"),
        MachineFinding("Two", State.WARNING, "is odd", "do this\nand that"),
        MachineFinding("Three", State.MISSING, "is gone", "get it"),
    )
    assert [line.rstrip() for line in text.splitlines()] == [
        "✓  One    works",
        "!  Two    is odd",
        "✗  Three  is gone",
        "",
        "! Two",
        "  do this",
        "  and that",
        "",
        "✗ Three",
        "  get it",
        "",
        "Fix every ✗ before you build or grade a course here. Failed: 1 of 3 (1 warning).",
    ]


def test_square_brackets_in_what_was_found_are_no_markup() -> None:
    assert "[red]/opt[/red]" in shown(MachineFinding("One", State.OK, "[red]/opt[/red]"))
