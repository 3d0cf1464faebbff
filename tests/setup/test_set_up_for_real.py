"""Set-up in full, from PyPI: with the wheels, and with a sourced ROS 2. Minutes, not seconds: `make soak`."""

from __future__ import annotations

import importlib
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from no_compiler import without_compilers
from sourced_ros import sourcing

from ros_in_python.ros2.executables import without_bootstrap
from spinbook.doctor.ros import wheels_installed

ROOT = Path(__file__).parents[2]
ROS2 = "packages/ros_in_python/tests/ros2"

pytestmark = [pytest.mark.soak, pytest.mark.timeout(1800)]


def clean_environment() -> dict[str, str]:
    """Return a terminal's environment if no environment is active and no ROS is sourced."""
    dropped = ("PYTHONPATH", "AMENT_PREFIX_PATH", "ROS_DISTRO", "VIRTUAL_ENV", "PYTEST_DISABLE_PLUGIN_AUTOLOAD")
    return {name: value for name, value in without_bootstrap(os.environ).items() if name not in dropped}


def checkout(folder: Path) -> Path:
    """A copy of this checkout as git has it: all files that are tracked, or will be."""
    listed = subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    for name in listed.stdout.splitlines():
        if (ROOT / name).is_file():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, folder / name)
    return folder


def make(folder: Path, environment: dict[str, str], *arguments: str) -> subprocess.CompletedProcess[str]:
    """Run make there."""
    python = f"PYTHON={getattr(sys, '_base_executable', sys.executable)}"
    return subprocess.run(
        ["make", python, *arguments], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )


def sourced(prefix: Path) -> dict[str, str]:
    """A ROS installation as sourcing one finds it, made from this environment's wheels; and the variables.

    It includes what breaks pytest in a real one: a plugin that is found on PYTHONPATH, made for an older pytest.
    """
    packages = prefix / "lib" / "python3" / "site-packages"
    packages.mkdir(parents=True)
    wheels = Path(importlib.import_module("rclpy").__path__[0]).parent
    (prefix / "share").symlink_to(Path(sys.prefix) / "share")
    for library in Path(sys.prefix, "lib").glob("*.so*"):
        (prefix / "lib" / library.name).symlink_to(library)
    for record in wheels.glob("ros_*.dist-info/RECORD"):
        for name in {line.split("/")[0] for line in record.read_text().splitlines()}:
            if (wheels / name).is_dir() and not name.endswith((".dist-info", ".libs")) and "bootstrapper" not in name:
                with_name = packages / name
                if not with_name.exists():
                    with_name.symlink_to(wheels / name)
    for libraries in wheels.glob("ros_*.libs"):
        for library in libraries.iterdir():
            if not (prefix / "lib" / library.name).exists():
                (prefix / "lib" / library.name).symlink_to(library)
    (packages / "launch_testing_like.py").write_text("raise ImportError('made for another pytest')\n")
    (packages / "launch_testing_like-1.dist-info").mkdir()
    (packages / "launch_testing_like-1.dist-info" / "METADATA").write_text("Name: launch-testing-like\nVersion: 1\n")
    (packages / "launch_testing_like-1.dist-info" / "entry_points.txt").write_text(
        "[pytest11]\nlaunch_testing_like = launch_testing_like\n"
    )
    return sourcing(prefix, packages, "jazzy")


def findings(folder: Path, environment: dict[str, str]) -> dict[str, dict[str, str]]:
    """Return the doctor's findings there, by name."""
    run = subprocess.run(
        [folder / ".venv" / "bin" / "spinbook", "doctor", "--json"],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    return {finding["name"]: finding for finding in json.loads(run.stdout)["findings"]}


def amiss(found: dict[str, dict[str, str]]) -> list[str]:
    return [name for name, finding in found.items() if finding["state"] == "missing" and name != "Sandbox"]


@pytest.mark.skipif(not wheels_installed(), reason="a prefix is made of this environment's wheels")
def test_a_sourced_ros_is_used_alone_and_an_environment_with_wheels_makes_way_for_it(tmp_path: Path) -> None:
    folder, clean = checkout(tmp_path / "spinbook"), clean_environment()

    first = make(folder, clean, "setup")
    assert first.returncode == 0, first.stderr
    found = findings(folder, clean)
    assert amiss(found) == []
    assert "PyPI wheels" in found["ROS 2"]["found"]

    ros = clean | sourced(tmp_path / "opt" / "ros" / "jazzy")
    found = findings(folder, ros)
    assert found["ROS 2"]["found"].startswith("two installations")

    second = make(folder, ros, "setup")
    assert second.returncode == 0, second.stderr
    assert "making it anew" in second.stderr
    assert list((folder / ".venv").glob("lib/python*/site-packages/ros_*")) == []
    found = findings(folder, ros)
    assert amiss(found) == []
    assert f"sourced, {ros['PYTHONPATH']}" in found["ROS 2"]["found"]

    # With `make test`'s own command, because a plugin of the sourced ROS would break a plain pytest.
    run = make(folder, ros, "-n", "test")
    pytest_line = next(line for line in run.stdout.splitlines() if line.startswith("PYTEST"))
    tried = subprocess.run(
        ["sh", "-c", f"{pytest_line} tests/spinbook/chapter {ROS2}/test_ros2_pub.py {ROS2}/test_ros2_interface.py"],
        cwd=folder,
        env=ros,
        capture_output=True,
        text=True,
        check=False,
    )
    assert tried.returncode == 0, tried.stdout[-3000:]


def test_a_handout_needs_no_compiler_for_services_actions_and_the_courses_own_interfaces(tmp_path: Path) -> None:
    course = checkout(tmp_path / "course")
    subprocess.run([sys.executable, "-m", "spinbook", "handout"], cwd=course, check=True)
    [archive] = (course / "build" / "handout").glob("*.zip")
    shutil.unpack_archive(archive, tmp_path / "student")
    [folder] = (tmp_path / "student").iterdir()
    environment = {**clean_environment(), "PATH": without_compilers(tmp_path / "programs"), "HOME": str(tmp_path)}
    python = getattr(sys, "_base_executable", sys.executable)

    def run(*command: str) -> str:
        done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout + done.stderr

    run(python, "-m", "venv", ".venv")
    run(".venv/bin/pip", "install", "--quiet", "-r", "requirements.txt")
    for exercise in ("calibration", "joint_mover"):
        shutil.copy(ROOT / "solutions" / exercise / "solution.py", folder / f"{exercise}.py")
        said = run(".venv/bin/spinbook", "check", exercise, f"{exercise}.py")
        assert "7 of 7 public checks" in said
        assert "ompiling" not in said
    assert "rmw_lockstep_prebuilt" in run(".venv/bin/spinbook", "doctor", "lockstep")
