"""`spinbook` itself: its help, and what it says when a part of the installation is missing."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import click
import pytest
from click.testing import CliRunner
from course_folder import CourseFolder
from prepared_python import run_prepared
from tree import ROOT

from spinbook import cli

#: Modules that take long to import; the help of `spinbook` needs none of them.
SLOW = ("rclpy", "matplotlib", "IPython", "nbclient", "sphinx", "pytest", "grader.exercise", "jinja2")


def test_help_imports_no_verb() -> None:
    program = (
        "import sys; from click.testing import CliRunner; from spinbook.cli import spinbook\n"
        "assert CliRunner().invoke(spinbook, ['--help']).exit_code == 0\n"
        f"print([name for name in {SLOW!r} if name in sys.modules])"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=120, check=True)

    assert done.stdout == "[]\n"


def test_a_folder_that_was_removed_is_a_sentence(tmp_path: Path) -> None:
    program = (
        "import os, sys; os.rmdir(os.getcwd()); from spinbook.cli import main; sys.argv = ['spinbook', 'lint']; main()"
    )
    done = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True, timeout=120)

    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("The folder that this terminal is in has been removed. Go to another one")


def test_help_names_every_verb_once() -> None:
    shown = CliRunner().invoke(cli.spinbook, ["--help"]).output

    listed = [line.split()[0] for line in shown.splitlines() if line.startswith("  ") and line[2:3].isalpha()]
    assert [name for name in listed if name in cli.VERBS] == list(cli.VERBS)


@pytest.mark.parametrize("name", cli.VERBS)
def test_every_verb_is_a_command_with_help_of_its_own(name: str) -> None:
    command = cli.spinbook.get_command(click.Context(cli.spinbook), name)

    assert command is not None
    assert command.help


def test_a_missing_extra_is_one_sentence_with_the_pip_command(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "libcst", None)
    for module in [name for name in sys.modules if name.startswith("grader.audit")]:
        monkeypatch.delitem(sys.modules, module)

    done = CliRunner().invoke(cli.spinbook, ["audit"])

    assert done.exit_code == 2
    assert "pip install 'spinbook[audit]'" in done.output
    assert "Traceback" not in done.output


@pytest.mark.parametrize("name", [name for name, verb in cli.VERBS.items() if verb.needs])
def test_without_ros_a_verb_that_needs_it_says_so_in_one_sentence(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "rclpy", None)

    done = CliRunner().invoke(cli.spinbook, [name, "joint_velocity"])

    assert done.exit_code == 2
    expected = f"`spinbook {name}` needs rclpy, which is not installed. Install it with: pip install 'spinbook[ros]'"
    assert done.output.splitlines()[-1] == f"Error: {expected}"


def test_the_help_of_a_verb_needs_no_ros(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "rclpy", None)

    assert CliRunner().invoke(cli.spinbook, ["check", "--help"]).exit_code == 0


def test_a_module_that_is_missed_only_while_a_verb_runs_is_one_sentence_too(
    course: CourseFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "livereload", None)
    course.write(**{"01-one": "# One\n\nText.\n"})

    done = CliRunner().invoke(cli.spinbook, ["site", "--serve", "--course", str(course.root)])

    assert done.exit_code == 2
    assert "`spinbook site` needs livereload" in done.output
    assert "pip install 'spinbook[site]'" in done.output


def test_a_place_that_can_not_be_written_is_named_without_a_traceback() -> None:
    exercise = ROOT / "spinbook" / "new" / "template" / "exercises" / "speed_limit"
    done = run_prepared("spinbook", "classroom50", str(exercise), "--out", "/sys/spinbook")
    assert done.returncode == 3, done.stdout
    assert done.stderr.startswith("/sys/spinbook: error: ")
    assert "Traceback" not in done.stderr


def test_the_readme_lists_every_command() -> None:
    rows = [row for row in (ROOT / "README.md").read_text(encoding="utf-8").splitlines() if row.startswith("| `")]
    commands = {re.sub(r"^\| `(spinbook )?|[ `].*", "", row) for row in rows}
    assert set(cli.VERBS) <= commands


def test_ros2_run_without_ros_says_how_to_install_it(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("ROS_IN_PYTHON", "own")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)

    done = CliRunner().invoke(cli.spinbook, ["ros2", "run", "turtlesim", "turtlesim_node"])

    assert done.exit_code == 1
    assert "pip install 'ros-jazzy-rclpy[fastrtps]'" in done.output


def test_grading_and_checking_need_nothing_of_what_notebooks_need() -> None:
    absent = ["IPython", "ipykernel", "jupytext", "nbclient", "nbformat"]
    modules = ["grader.gradescope.run", "grader.classroom50.run", "grader.workers.worker", "spinbook.submit.program"]
    modules += [verb.command.partition(":")[0] for verb in (*cli.INSTRUCTORS.values(), *cli.STUDENTS.values())]
    code = f"import sys; sys.modules.update(dict.fromkeys({absent}))\nimport {', '.join(modules)}"

    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)

    assert done.returncode == 0, done.stderr
