"""What Gradescope gets, and the autograder that is uploaded there."""

from __future__ import annotations

import json
import os
import platform
import re
import shutil
import stat
import subprocess
import sys
import zipfile
from dataclasses import replace
from importlib import metadata
from io import BytesIO
from pathlib import Path

import plain_grades as plain
import pytest
from click.testing import CliRunner
from small_class import EXERCISE, TEMPLATE

from grader.classroom50.command import classroom50
from grader.classroom50.run import result, summary
from grader.exercise import load
from grader.gradescope.command import bundle
from grader.gradescope.own_wheel import as_wheel, wheel_contents
from grader.gradescope.pins import pinned
from grader.grading.grade import Adjustment
from grader.report.as_json import gradescope_results as results
from interface_compiler import activation, prefixes


def test_public_checks_are_seen_at_once_and_hidden_ones_when_grades_are_published() -> None:
    shown = results(plain.entry(plain.HALF))
    assert shown["score"] == 6
    assert shown["stdout_visibility"] == "hidden"
    public, hidden = shown["tests"]
    assert (public["visibility"], public["score"], public["max_score"], public["status"]) == ("visible", 6, 6, "passed")
    assert (hidden["visibility"], hidden["score"], hidden["status"]) == ("after_published", 0, "failed")


def test_of_a_hidden_check_no_name_scenario_or_number_is_reported() -> None:
    text = json.dumps(results(plain.entry(plain.HALF)))
    assert "Think of stamps." in text
    for secret in ("test_secret_gap", "31.40", "expected 2.5", '"gap"'):
        assert secret not in text


def test_late_work_counts_there_too() -> None:
    shown = results(plain.entry(plain.HALF, adjustments=(Adjustment("late", -1.0, "handed in 1 h late"),)))
    assert shown["score"] == 5
    assert "-1 points: handed in 1 h late" in shown["output"]


def test_what_pypi_did_not_install_here_is_asked_for_in_any_version() -> None:
    """A machine whose ROS 2 comes from Debian knows no version of PyPI's."""
    assert pinned("numpy") == f"numpy=={metadata.version('numpy')}"
    assert pinned("ros-jazzy-of-another-machine") == "ros-jazzy-of-another-machine"


def test_a_fault_of_ours_has_no_score() -> None:
    shown = results(plain.entry(plain.FAULT))
    assert "score" not in shown
    assert "tests" not in shown
    assert "not your fault" in shown["output"]


@pytest.fixture
def no_cache_of_ours(monkeypatch: pytest.MonkeyPatch) -> None:
    """Keeps the solution's recordings in a folder of its own, as an autograder does."""
    monkeypatch.delenv("SPINBOOK_CACHE")


@pytest.fixture(scope="module")
def zipped() -> bytes:
    """The zip for Gradescope."""
    return bundle(load(TEMPLATE / "exercises" / EXERCISE))


@pytest.fixture(scope="module")
def autograder(zipped: bytes, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder /autograder of a container, with the uploaded zip unpacked in it and this environment as its own."""
    root = tmp_path_factory.mktemp("autograder")
    with zipfile.ZipFile(BytesIO(zipped)) as archive:
        archive.extractall(root / "source")
        for entry in archive.infolist():
            os.chmod(root / "source" / entry.filename, stat.S_IMODE(entry.external_attr >> 16))  # noqa: PTH101
    (root / "source" / "venv").symlink_to(sys.prefix)
    (root / "submission").mkdir()
    (root / "run_autograder").write_bytes((root / "source" / "run_autograder").read_bytes())
    return root


def graded(root: Path, source: str) -> dict[str, object]:
    """Return what run_autograder writes for a submission."""
    (root / "submission" / "my node.py").write_text(source, encoding="utf-8")
    (root / "submission_metadata.json").write_text(
        json.dumps({"created_at": "2026-11-20T23:41:07.000000-08:00", "users": [{"id": 7, "name": "Ada"}]})
    )
    subprocess.run(["bash", str(root / "run_autograder")], check=True, timeout=280, stdout=subprocess.DEVNULL)
    shown: dict[str, object] = json.loads((root / "results" / "results.json").read_text(encoding="utf-8"))
    return shown


def test_the_zip_holds_the_two_scripts_and_of_the_solutions_only_one(autograder: Path) -> None:
    source = autograder / "source"
    for script in ("setup.sh", "run_autograder"):
        assert os.access(source / script, os.X_OK)
        assert subprocess.run(["bash", "-n", str(source / script)], check=False).returncode == 0
    solutions = [file.name for file in (source / "course" / "solutions").rglob("*") if file.is_file()]
    assert solutions == ["solution.py"]


def test_what_the_container_installs_is_pinned_with_hashes_for_every_python(autograder: Path) -> None:
    pins = "".join((autograder / "source" / "course" / name).read_text() for name in ("pins.txt", "pins-ros.txt"))
    entries = re.split(r"^(?=[a-z])", pins, flags=re.MULTILINE)[1:]
    names = {entry.partition("==")[0] for entry in entries}
    assert {
        "click",
        "numpy",
        "tomli",
        "ros-jazzy-rclpy",
    } <= names
    assert not names & {
        "sphinx",
        "mypy",
        "jupyterlab",
        "empy",
        "setuptools",
        "spinbook",
        "ros-fastrtps",
        "ros-rmw-fastrtps-cpp",
        "ros-test-msgs",
        "matplotlib",
    }
    plots = (autograder / "source" / "course" / "pins-plots.txt").read_text()
    assert {"fonttools", "matplotlib", "pillow", "six"} <= set(re.findall(r"^[a-z]+", plots, re.MULTILINE))
    assert all("--hash=sha256:" in entry for entry in entries)


def test_the_zip_holds_wheels_of_all_that_would_have_to_be_compiled(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    compiled_package("arm_msgs", tmp_path)
    monkeypatch.setenv(activation.VARIABLE, str(tmp_path))
    with zipfile.ZipFile(BytesIO(bundle(load(TEMPLATE / "exercises" / EXERCISE)))) as archive:
        names = archive.namelist()
    wheels = {name.partition("-")[0]: name for name in names if name.startswith("course/wheels/")}
    interfaces = {
        f"course/wheels/compiled_interfaces_{name}" for name in ("arm_msgs", "example_interfaces", "turtlesim")
    }
    assert {"course/wheels/rmw_lockstep_prebuilt", *interfaces} <= set(wheels)
    assert all(name.endswith(f"-manylinux_2_28_{platform.machine()}.whl") for name in wheels.values())
    assert "course/course.toml" in names


def compiled_package(name: str, prefix: Path) -> None:
    """Write what tells a compiled package from others, and its Python package."""
    for file in (
        f"share/{name}/{prefixes.KEY}",
        f"{prefixes.RESOURCES}/packages/{name}",
        f"{prefixes.PYTHON}/{name}/x.py",
    ):
        (prefix / file).parent.mkdir(parents=True, exist_ok=True)
        (prefix / file).write_text("1\n")


def test_the_same_content_makes_the_same_zip(zipped: bytes) -> None:
    assert bundle(load(TEMPLATE / "exercises" / EXERCISE)) == zipped


@pytest.mark.usefixtures("no_cache_of_ours")
def test_the_autograder_grades_what_was_uploaded(autograder: Path) -> None:
    right = (TEMPLATE / "solutions" / EXERCISE / "solution.py").read_text(encoding="utf-8")
    assert graded(autograder, right)["score"] == 20
    assert graded(autograder, "import rclpy\nrclpy.spin(\n")["score"] == 0


def test_an_autograder_that_is_broken_gives_no_score(autograder: Path) -> None:
    checks = autograder / "source" / "course" / "exercises" / EXERCISE / "exercise.toml"
    text = checks.read_text(encoding="utf-8")
    checks.write_text("points = ", encoding="utf-8")
    try:
        shown = graded(autograder, "pass\n")
    finally:
        checks.write_text(text, encoding="utf-8")
    assert "score" not in shown
    assert "not your fault" in str(shown["output"])


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a wheel of Spinbook, and in `site` what is installed from it, outside its checkout."""
    folder = tmp_path_factory.mktemp("installed")
    name, content = as_wheel(wheel_contents())
    (folder / name).write_bytes(content)
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-index", "--target"]
    subprocess.run([*pip, str(folder / "site"), str(folder / name)], check=True, timeout=280)
    return folder


def test_an_installed_wheel_makes_the_autograder_with_itself_and_its_versions_in_it(
    installed: Path, tmp_path: Path
) -> None:
    command = [sys.executable, "-m", "spinbook", "gradescope", str(TEMPLATE / "exercises" / EXERCISE), "--out", "a.zip"]
    environment = {**os.environ, "PYTHONPATH": str(installed / "site")}
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=280)
    assert done.returncode == 0, done.stderr
    with zipfile.ZipFile(tmp_path / "a.zip") as archive:
        names = archive.namelist()
        wheel = "spinbook-0.1.0-py3-none-any.whl"
        with zipfile.ZipFile(BytesIO(archive.read(f"course/{wheel}"))) as inner:
            packed = set(inner.namelist())
            assert inner.testzip() is None
        pins = archive.read("course/pins.txt").decode().splitlines()
    assert {"grader/command.py", "rmw_lockstep/CMakeLists.txt", "interface_compiler/activation.py"} <= packed
    assert "spinbook/new/template/course.toml" in packed
    assert f"course/solutions/{EXERCISE}/solution.py" in names
    assert any(pin.startswith("numpy==") for pin in pins)
    with zipfile.ZipFile(installed / wheel) as first:
        assert packed == set(first.namelist()), "another can be made from what is installed from it"


#: The fields that Classroom 50's collector requires, besides those that its runner adds.
RESULT_FIELDS = {
    *("schema", "classroom", "assignment", "submission", "commit", "release", "review", "datetime"),
    *("score", "max-score", "tests"),
}
RUNNER = {
    "CLASSROOM": "ros",
    "ASSIGNMENT": "speed-limit",
    "SUBMISSION_TAG": "submit/2026-11-20T23-41-07Z-a1b2c3d",
    "COMMIT_URL": "https://github.com/o/r/commit/a1b2c3d",
    "RELEASE_URL": "https://github.com/o/r/releases/tag/submit%2F2026-11-20T23-41-07Z-a1b2c3d",
    "REVIEW_URL": "https://github.com/o/r/compare/0...a1b2c3d",
}


def test_a_grade_is_a_result_of_classroom_50() -> None:
    made = result(plain.HALF, RUNNER)
    assert set(made) == RESULT_FIELDS
    assert (made["schema"], made["classroom"], made["assignment"]) == ("classroom50/result/v1", "ros", "speed-limit")
    assert (made["score"], made["max-score"]) == (6, 10)
    assert [(test["test-name"], test["passed"], test["score"], test["max-score"]) for test in made["tests"]] == [
        ("It answers each message.", True, 6, 6),
        ("It survives a long gap.", False, 0, 4),
    ]
    for secret in ("test_secret_gap", "31.40", "expected 2.5"):
        assert secret not in json.dumps(made)
        assert secret not in summary(plain.HALF, "Speed")
    halves = plain.grade(replace(plain.PUBLIC, points=2.5))
    assert (result(halves, RUNNER)["score"], result(halves, RUNNER)["max-score"]) == (250, 250)
    job = {"GITHUB_SERVER_URL": "https://github.com", "GITHUB_REPOSITORY": "o/r", "GITHUB_SHA": "abc"}
    assert result(plain.HALF, job)["review"] == "https://github.com/o/r/commit/abc"


@pytest.mark.usefixtures("no_cache_of_ours")
def test_classroom_50s_runner_gets_a_result_whatever_is_in_the_repository_and_after_a_fault_of_ours_none(
    tmp_path: Path,
) -> None:
    done = CliRunner().invoke(classroom50, [str(TEMPLATE / "exercises" / EXERCISE), "--out", str(tmp_path / "grader")])
    assert done.exit_code == 0, done.output
    (tmp_path / "grader" / "venv").symlink_to(sys.prefix)
    repository = tmp_path / "repository"
    repository.mkdir()
    solution = TEMPLATE / "solutions" / EXERCISE / "solution.py"
    shutil.copy(solution, repository / "speed_limit.py")
    forged = "open('result.json', 'w').write('{\"score\": 99}')\nraise SystemExit(0)\n"
    for name in ("json", "rich", "numpy", "click"):
        (repository / f"{name}.py").write_text(forged)
    (repository / "result.json").write_text('{"score": 99}')
    (repository / "release-body.md").mkdir()
    command = [sys.executable, str(tmp_path / "grader" / "autograder.py")]
    environment = {**os.environ, **RUNNER, "GITHUB_STEP_SUMMARY": str(tmp_path / "summary.md")}
    subprocess.run(command, cwd=repository, env=environment, check=True, timeout=280)
    made = json.loads((repository / "result.json").read_text(encoding="utf-8"))
    assert (made["score"], made["max-score"]) == (20, 20)
    assert "20 of 20 points" in (repository / "release-body.md").read_text(encoding="utf-8")
    assert "20 of 20 points" in (tmp_path / "summary.md").read_text(encoding="utf-8")
    (repository / "result.json").unlink()
    (tmp_path / "grader" / "course" / "exercises" / EXERCISE / "exercise.toml").write_text("points = ")
    assert subprocess.run(command, cwd=repository, env=environment, timeout=280).returncode == 1
    assert not (repository / "result.json").exists()
