"""`spinbook new` makes a course, or an exercise, that works at once."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import nbformat
import pytest
from click.testing import CliRunner, Result
from prepared_python import run_prepared

import grader
import groundwork
import interface_compiler
import rcl_python
import rmw_lockstep
import ros_in_python
import spinbook
from spinbook.course.course import read_course
from spinbook.new.command import new
from spinbook.problem import SpinbookError


def run(*command: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTEST_ADDOPTS": ""}
    if command[:2] != ("spinbook", "new") and command[0] == "spinbook":
        return run_prepared(*command, cwd=cwd, env=environment)
    return subprocess.run(
        [sys.executable, "-m", *command], cwd=cwd, env=environment, capture_output=True, text=True, timeout=560
    )


def made(*words: str) -> Result:
    return CliRunner().invoke(new, words)


@pytest.fixture(scope="module")
def pristine(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A new course with one more exercise in it. Not to be changed."""
    folder = tmp_path_factory.mktemp("new") / "My-Robots"
    assert run("spinbook", "new", str(folder), cwd=folder.parent).returncode == 0
    done = run("spinbook", "new", "--exercise", "gripper_force", cwd=folder / "chapters")
    assert done.returncode == 0, done.stderr
    return folder


@pytest.fixture
def course(pristine: Path, tmp_path: Path) -> Path:
    """A new course for this test alone."""
    return shutil.copytree(pristine, tmp_path / "course")


def test_the_course_has_its_names(pristine: Path) -> None:
    course = read_course(pristine)
    assert (course.title, course.package.name, course.package.workspace) == ("My robots", "my_robots", "my_robots_ws")
    assert course.exercises == {"speed_limit", "gripper_force"}
    everything = "".join(file.read_text() for file in pristine.rglob("*") if file.is_file())
    assert "first course" not in everything.lower().replace("_", " ")
    assert (pristine / ".gitignore").exists()
    assert (pristine / ".github" / "workflows" / "course.yml").exists()


def test_the_exercise_has_its_names(pristine: Path) -> None:
    files = [file for part in ("exercises", "solutions") for file in (pristine / part / "gripper_force").rglob("*.*")]
    text = "".join(file.read_text() for file in files)
    assert all(name in text for name in ('"gripper_force.py"', "class GripperForce(Node)", "# Gripper force"))


def test_its_chapter_has_nothing_to_fix(course: Path) -> None:
    done = run("spinbook", "lint", "--strict", cwd=course)
    assert done.returncode == 0, done.stdout
    assert "0 errors, 0 warnings" in done.stdout


def test_its_notebook_has_two_nodes_and_the_exercises_starter(course: Path) -> None:
    done = run("spinbook", "build", cwd=course)
    assert done.returncode == 0, done.stdout + done.stderr
    notebook = nbformat.read(course / "build" / "notebooks" / "01-two-nodes-and-a-topic.ipynb", as_version=4)
    begins = [cell.source.split("\n")[0] for cell in notebook.cells if cell.source.startswith("%%node")]
    assert [line.split()[1] for line in begins] == ["speed_publisher", "speed_monitor", "speed_limit"]
    assert "SOLUTION" not in str(notebook)


@pytest.mark.parametrize(
    ("chosen", "passed"), [("starter", "1 passed"), pytest.param("", "3 passed", marks=pytest.mark.soak)]
)
def test_its_own_tests_prove_the_exercise(course: Path, chosen: str, passed: str) -> None:
    """The solution gets full marks and the starter nothing; in the soak, every solution and mistake is graded."""
    shutil.rmtree(course / "exercises" / "gripper_force")
    done = run("pytest", "-q", "-p", "no:cacheprovider", "-k", chosen, "tests", cwd=course)
    assert done.returncode == 0, done.stdout
    assert passed in done.stdout


def test_a_mistake_is_reported_with_units(course: Path) -> None:
    done = run("spinbook", "grade", "speed_limit", "--mistake", "only_forwards", cwd=course)
    assert done.returncode == 1
    assert "15 of 20 points" in done.stdout
    assert "expected data -1 m/s, got -" in " ".join(done.stdout.split())


@pytest.mark.soak
def test_its_notebook_runs(course: Path) -> None:
    done = run("spinbook", "build", "--execute", cwd=course)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("name", ["my robots", "3d", "rclpy", "json", "class", "müll", "a/b c", "."])
def test_a_course_with_a_name_that_will_not_do_is_refused(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    done = made(name)
    assert isinstance(done.exception, SpinbookError)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "name", ["Speed", "1_speed", "speed-limit", "speed__limit", "numpy", "import", "checks", "../x", "", "x.py"]
)
def test_an_exercise_with_a_name_that_will_not_do_is_refused(
    name: str, course: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(course)
    done = made("--exercise", name)
    assert isinstance(done.exception, SpinbookError)
    assert len(list((course / "exercises").iterdir())) == 2


def test_what_exists_is_never_overwritten(course: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(course)
    shutil.rmtree("exercises/gripper_force")
    before = sorted((file, file.read_bytes()) for file in course.rglob("*") if file.is_file())
    for words in ([str(course)], ["--exercise", "speed_limit"], ["--exercise", "gripper_force"]):
        done = made(*words)
        assert isinstance(done.exception, SpinbookError)
        assert "already" in str(done.exception)
    assert sorted((file, file.read_bytes()) for file in course.rglob("*") if file.is_file()) == before


def test_an_exercise_outside_a_course_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    done = made("--exercise", "gripper_force")
    assert "no course.toml" in str(done.exception)


@pytest.mark.parametrize("title", ['My "Robots"', "two\nlines", " "])
def test_a_title_that_would_break_a_file_is_refused(
    title: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert isinstance(made("robots", "--title", title).exception, SpinbookError)


@pytest.mark.parametrize("words", [[], ["robots", "--exercise", "speed"]])
def test_either_a_course_or_an_exercise(words: list[str]) -> None:
    done = made(*words)
    assert done.exit_code == 2
    assert "one of these" in done.output


def test_the_untouched_course_can_be_handed_out(course: Path) -> None:
    done = run("spinbook", "handout", cwd=course)

    assert done.returncode == 0, done.stdout + done.stderr
    assert "no solution and no hidden check among them" in done.stdout


@pytest.mark.soak
def test_an_audit_of_the_untouched_course_has_nothing_to_fix(pristine: Path, tmp_path: Path) -> None:
    for number in range(2):
        environment = {**os.environ, "PYTEST_ADDOPTS": "", "SPINBOOK_CACHE": str(tmp_path / f"cache{number}")}
        command = [sys.executable, "-m", "spinbook", "audit"]
        done = subprocess.run(command, cwd=pristine, env=environment, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr


def test_a_spinbook_that_came_with_a_handout_says_that_it_has_no_templates(tmp_path: Path) -> None:
    without = shutil.ignore_patterns("template", "kinds", "__pycache__")
    for package in (spinbook, grader, groundwork, interface_compiler, rmw_lockstep, rcl_python, ros_in_python):
        folder = Path(package.__path__[0])
        shutil.copytree(folder, tmp_path / folder.name, ignore=without)

    done = run("spinbook", "new", "robots", cwd=tmp_path)

    assert done.returncode == 1
    assert "this installation has no templates of courses and exercises" in done.stderr
    assert "Use a checkout of Spinbook: git clone" in done.stderr
    assert not (tmp_path / "robots").exists()
