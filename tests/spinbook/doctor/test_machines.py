"""What the doctor finds on machines with a problem."""

from __future__ import annotations

import importlib
import json
import os
import sys
from dataclasses import asdict
from pathlib import Path

import pytest
from running import doctor, finding_of

from grader.sandbox import Isolation, isolation
from ros_in_python.ros2.executables import GUARD
from spinbook.doctor import machine, middleware, python_build, ros, sandbox
from spinbook.doctor.diagnosis import State
from spinbook.doctor.ros import wheels_installed
from spinbook.update.handout import BASE

with_wheels = pytest.mark.skipif(not wheels_installed(), reason="ROS 2 is a sourced one here")


def program(folder: Path, name: str, text: str) -> str:
    """Return a PATH on which this program comes first."""
    file = folder / name
    file.write_text(f"#!/bin/sh\n{text}\n")
    file.chmod(0o755)
    return f"{folder}:{os.environ['PATH']}"


def test_a_middleware_that_is_not_installed_is_named_and_what_needs_it_is_not_tried() -> None:
    run = doctor("--json", "ros", "middleware", "message", RMW_IMPLEMENTATION="rmw_nowhere_cpp")
    ros, middleware, message = json.loads(run.stdout)["findings"]
    assert run.returncode == 1
    assert ros["state"] == "ok"
    assert middleware["state"] == "missing"
    assert "'rmw_nowhere_cpp', which is not installed" in middleware["found"]
    assert "unset RMW_IMPLEMENTATION" in middleware["fix"]
    assert message["found"] == "not checked, because this failed: Middleware"


@with_wheels
def test_a_guard_that_outlived_its_library_path_is_the_cause_that_is_reported() -> None:
    run = doctor("--json", "libraries", "ros", **{GUARD: "1", "LD_LIBRARY_PATH": None})
    libraries, ros = json.loads(run.stdout)["findings"]
    assert libraries["state"] == "missing"
    assert f"unset {GUARD} LD_LIBRARY_PATH" in libraries["fix"]
    assert ros["found"] == "not checked, because this failed: Library path"


@with_wheels
def test_libraries_of_another_ros_beside_the_wheels_are_a_warning(tmp_path: Path) -> None:
    (tmp_path / "librcl.so").touch()
    own = os.environ.get("LD_LIBRARY_PATH", f"{sys.prefix}/lib")
    finding = finding_of("libraries", **{GUARD: "1", "LD_LIBRARY_PATH": f"{own}:{tmp_path}"})
    assert finding["state"] == "warning"
    assert os.fspath(tmp_path) in finding["found"]


@with_wheels
def test_a_sourced_ros_beside_the_wheels_is_a_fault(tmp_path: Path) -> None:
    sourced = tmp_path / "site-packages"
    sourced.mkdir()
    (sourced / "rclpy").symlink_to(Path(importlib.import_module("rclpy").__path__[0]))
    finding = finding_of("ros", PYTHONPATH=os.fspath(sourced))
    assert finding["state"] == "missing"
    assert finding["found"].startswith("two installations")
    assert os.fspath(sourced) in finding["found"]
    assert "make setup" in finding["fix"]


def test_a_sourced_ros_that_is_too_old_is_a_fault(tmp_path: Path) -> None:
    (tmp_path / "rclpy").mkdir()
    (tmp_path / "rclpy" / "__init__.py").touch()
    finding = finding_of("ros", PYTHONPATH=os.fspath(tmp_path), ROS_DISTRO="foxy")
    assert finding["state"] == "missing"
    assert "Foxy" in finding["found"]


@pytest.mark.parametrize(
    ("variable", "value", "fix"),
    [
        ("ROS_DOMAIN_ID", "kitchen", "export ROS_DOMAIN_ID=0"),
        ("ROS_DOMAIN_ID", "230", "export ROS_DOMAIN_ID=0"),
        ("FASTRTPS_DEFAULT_PROFILES_FILE", "/nowhere/profile.xml", "unset FASTRTPS_DEFAULT_PROFILES_FILE"),
        ("ROS_AUTOMATIC_DISCOVERY_RANGE", "OFF", "unset ROS_AUTOMATIC_DISCOVERY_RANGE"),
        ("ROS_DISCOVERY_SERVER", "10.0.0.1:11811", "unset ROS_DISCOVERY_SERVER"),
    ],
)
def test_settings_that_surprise_are_warned_of(
    monkeypatch: pytest.MonkeyPatch, variable: str, value: str, fix: str
) -> None:
    monkeypatch.setenv(variable, value)
    finding = ros.examine_ros_settings()
    assert finding.state is State.WARNING
    assert variable in finding.found
    assert fix in finding.fix


def test_a_log_folder_that_can_not_be_written_is_a_fault(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_LOG_DIR", "/proc/nowhere")
    finding = middleware.examine_log_folder()
    assert finding.state is State.MISSING
    assert "/proc/nowhere" in finding.found


def test_without_a_home_there_is_another_place_for_logs(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("HOME", "ROS_LOG_DIR", "ROS_HOME"):
        monkeypatch.delenv(name, raising=False)
    finding = middleware.examine_log_folder()
    assert finding.state is State.WARNING
    assert "ROS_LOG_DIR" in finding.fix


def test_a_course_in_a_folder_with_a_space_is_a_fault(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    course = tmp_path / "My Course"
    course.mkdir()
    monkeypatch.chdir(course)
    finding = machine.examine_folder()
    assert finding.state is State.MISSING
    assert os.fspath(course) in finding.found

    (course / BASE).mkdir(parents=True)
    finding = machine.examine_folder()
    assert finding.state is State.WARNING  # notebooks and checks work
    assert "make" not in finding.fix

    (course / "one; two").mkdir()
    monkeypatch.chdir(course / "one; two")
    assert machine.examine_folder().state is State.MISSING  # the loader's paths end at a semicolon


def test_a_newer_setuptools_that_copies_in_place_of_linking_is_warned_of(tmp_path: Path) -> None:
    (tmp_path / "setuptools-80.9.0.dist-info").mkdir()
    (tmp_path / "setuptools-80.9.0.dist-info" / "METADATA").write_text("Name: setuptools\nVersion: 80.9.0\n")
    path = f"{tmp_path}{os.pathsep}{os.environ.get('PYTHONPATH', '')}".rstrip(os.pathsep)
    finding = finding_of("colcon", PYTHONPATH=path)
    assert finding["state"] == "warning"
    assert "setuptools 80.9.0" in finding["found"]


def test_a_missing_compiler_is_a_warning_with_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    program(tmp_path, "apt-get", "exit 0")
    monkeypatch.setenv("PATH", os.fspath(tmp_path))
    finding = machine.examine_compiler()
    assert finding.state is State.WARNING
    assert finding.found == "not found: gcc, g++"
    assert "sudo apt-get install g++" in finding.fix


def test_namespaces_that_are_not_allowed_are_a_warning_with_the_kernels_own_words(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    refuses = "echo 'unshare: unshare failed: Operation not permitted' >&2; exit 1"
    monkeypatch.setenv("PATH", program(tmp_path, "unshare", refuses))
    finding = sandbox.examine_namespaces()
    assert finding.state is State.WARNING
    assert "user: unshare failed: Operation not permitted" in finding.found


@pytest.mark.parametrize("text", ["exit 1", "echo 'bwrap: No permissions to create new namespace' >&2; exit 1"])
def test_a_bubblewrap_that_fails_is_a_warning(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, text: str) -> None:
    monkeypatch.setenv("PATH", program(tmp_path, "bwrap", text))
    assert sandbox.examine_bubblewrap().state is State.WARNING


def test_a_browser_is_one_that_shows_a_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shows = 'for last; do :; done; echo "${last#data:text/html,}"'
    monkeypatch.setenv("PATH", program(tmp_path, "chromium", shows))
    assert machine.examine_browser().state is State.OK
    program(tmp_path, "chromium", "echo 'error while loading shared libraries: libnss3.so' >&2; exit 127")
    finding = machine.examine_browser()
    assert finding.state is State.WARNING
    assert "libnss3.so" in finding.found


@pytest.mark.parametrize(
    ("working", "state"),
    [
        (("bubblewrap", "none"), "ok"),
        (("namespaces",), "ok"),
        (("landlock", "none"), "warning"),
        (("none",), "missing"),
    ],
)
def test_the_strongest_sandbox_that_works_decides(
    monkeypatch: pytest.MonkeyPatch, working: tuple[str, ...], state: str
) -> None:
    levels = {level: None if level.value in working else "not allowed" for level in Isolation}
    monkeypatch.setattr(isolation, "available", lambda: levels)
    finding = sandbox.examine_sandbox()
    assert finding.state.value == state
    assert bool(finding.fix) is (state != "ok")


@pytest.mark.parametrize("version", [(3, 9, 2), (3, 15, 0)])
def test_a_python_that_is_not_supported_is_a_fault(monkeypatch: pytest.MonkeyPatch, version: tuple[int, ...]) -> None:
    monkeypatch.setattr(sys, "version_info", version)
    assert machine.examine_python().state.value == "missing"


def test_a_python_without_optimizations_is_a_warning_that_names_a_faster_build(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    version = "{}.{}".format(*sys.version_info[:2])
    build = python_build.PythonBuild("/usr/bin/python", version, optimized=True, complete=True)
    monkeypatch.setattr(python_build, "is_optimized", lambda: False)
    monkeypatch.setenv("PATH", program(tmp_path, f"python{version}", f"echo '{json.dumps(asdict(build))}'"))
    finding = machine.examine_python()
    assert finding.state is State.WARNING
    assert finding.found.endswith("compiled without optimizations")
    assert "make PYTHON=/usr/bin/python setup" in finding.fix


def test_without_a_faster_build_the_warning_says_how_to_make_one(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(python_build, "is_optimized", lambda: False)
    monkeypatch.setenv("PATH", "")
    assert "--enable-optimizations" in machine.examine_python().fix


def test_a_python_with_optimizations_is_fine(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(python_build, "is_optimized", lambda: True)
    assert machine.examine_python().state is State.OK
