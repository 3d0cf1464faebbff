"""Submissions a minute, side by side with nbgrader and otter-grader: the same exercise, scenarios and submissions.

    python benchmarks/class/against_others.py --submissions 2 --ours 24

The others play each scenario in real time, as they must: they know no simulated time. So a few submissions show their
pace; each is one of those that Spinbook grades in the same run. They are installed from PyPI into an environment of
their own (--environment), with the same ROS 2.
"""

from __future__ import annotations

import argparse
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from grade_all import grade
from others_course import (
    ASSIGNMENT,
    hand_in_nbgrader,
    hand_in_otter,
    lay_scenarios,
    nbgrader_course,
    otter_tests,
)
from students import EXERCISE, FILE, ROOT, SOLUTIONS
from variants import reworded

from grader.exercise import load
from grader.exercise.mistakes import mistake_of
from grader.grading import Options, grading_of
from grader.workers import WorkerPool
from spinbook.kernel.environment import LOOPBACK_PROFILE

PINS = (
    "nbgrader==0.9.6",
    "otter-grader==7.0.0",
    "ros-jazzy-rclpy[fastrtps]==7.1.6",
    "ros-jazzy-common-interfaces==5.3.6",
)

MAIN = "\n\ndef main("


def main() -> int:
    """Install, make, grade three times, tell."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--submissions", type=int, default=2, help="how many the others grade")
    parser.add_argument("--ours", type=int, default=24, help="how many Spinbook grades; the others' are among them")
    parser.add_argument("--environment", type=Path, default=ROOT / "build" / "others", help="where the others live")
    wanted = parser.parse_args()
    install(wanted.environment)
    base = Path(tempfile.mkdtemp(prefix="spinbook-others-"))
    try:
        students = the_students(wanted.ours)
        theirs = dict(list(students.items())[: wanted.submissions])
        with WorkerPool() as workers:
            grading = grading_of(load(ROOT / "exercises" / EXERCISE), Options(), workers)
            lasts = lay_scenarios(grading, base / "lib")
            names = [scenario.name for scenario in grading.runner.scenarios]
        print(f"{len(names)} scenarios, {lasts:.0f} s of robot time", flush=True)
        rates = {"spinbook": ours(base / "ours", students)}
        rates["nbgrader autograde"] = nbgrader(base / "nbgrader", wanted.environment, names, base / "lib", theirs)
        rates["otter run"] = otter(base / "otter", wanted.environment, names, base / "lib", theirs)
    finally:
        shutil.rmtree(base, ignore_errors=True)
    for name, rate in rates.items():
        print(f"{name:20} {rate:6.2f} submissions a minute   spinbook is {rates['spinbook'] / rate:.0f} times as fast")
    print(f"load at the end: {os.getloadavg()[0]:.1f} on {len(os.sched_getaffinity(0))} cores")
    return 0


def install(environment: Path) -> None:
    """An environment with the others and ROS 2, unless it is there."""
    if not (environment / "bin" / "nbgrader").exists():
        subprocess.run([sys.executable, "-m", "venv", str(environment)], check=True)
        subprocess.run([str(environment / "bin" / "pip"), "install", "--quiet", *PINS], check=True, env=_clean())


def the_students(count: int) -> dict[str, str]:
    """Code by student: the solution and one usual mistake by turns, each in other words."""
    chance = random.Random(1)
    exercise = load(ROOT / "exercises" / EXERCISE)
    texts = [(SOLUTIONS / "solution.py").read_text(encoding="utf-8"), mistake_of(exercise, "fixed_dt").source]
    return {f"student{n:03}": reworded(texts[n % 2], f"student{n:03}", chance) for n in range(count)}


def ours(folder: Path, students: dict[str, str]) -> float:
    """Submissions a minute of `spinbook grade`, after one that makes ready what is made once for an exercise."""
    for part, codes in (("ready", dict(list(students.items())[:2])), ("all", students)):
        for student, code in codes.items():
            (folder / part / student).mkdir(parents=True)
            (folder / part / student / FILE).write_text(code, encoding="utf-8")
        seconds, _ = grade(folder / part, folder / f"{part}-results", None, quiet=True)
    print(f"spinbook: {seconds / len(students):.1f} s a submission", flush=True)
    return 60 * len(students) / seconds


def nbgrader(folder: Path, environment: Path, names: list[str], lib: Path, students: dict[str, str]) -> float:
    """Submissions a minute of `nbgrader autograde`."""
    folder.mkdir()
    nbgrader_course(folder, names, lib)
    command = str(environment / "bin" / "nbgrader")
    _run([command, "generate_assignment", ASSIGNMENT], folder, environment)
    for student, code in students.items():
        hand_in_nbgrader(folder, student, code.split(MAIN)[0])
    began = time.monotonic()
    printed = _run([command, "autograde", ASSIGNMENT], folder, environment)
    seconds = time.monotonic() - began
    graded = list((folder / "autograded").glob(f"*/{ASSIGNMENT}/*.ipynb"))
    assert len(graded) == len(students), printed
    print(f"nbgrader: {seconds / len(students):.1f} s a submission", flush=True)
    return 60 * len(students) / seconds


def otter(folder: Path, environment: Path, names: list[str], lib: Path, students: dict[str, str]) -> float:
    """Submissions a minute of `otter run`, which grades one after another and without a container."""
    folder.mkdir()
    otter_tests(folder, names, lib)
    command = str(environment / "bin" / "otter")
    _run([command, "generate", "-t", "tests", "--no-environment"], folder, environment)
    began = time.monotonic()
    for student, code in students.items():
        notebook = hand_in_otter(folder, student, code.split(MAIN)[0])
        (folder / student).mkdir(exist_ok=True)
        _run([command, "run", "-a", "autograder.zip", "-o", student, str(notebook)], folder, environment)
    seconds = time.monotonic() - began
    print(f"otter: {seconds / len(students):.1f} s a submission", flush=True)
    return 60 * len(students) / seconds


def _run(command: list[str], folder: Path, environment: Path) -> str:
    ros = {"FASTRTPS_DEFAULT_PROFILES_FILE": str(LOOPBACK_PROFILE), "ROS_AUTOMATIC_DISCOVERY_RANGE": "SYSTEM_DEFAULT"}
    path = f"{environment / 'bin'}{os.pathsep}{os.environ['PATH']}"
    done = subprocess.run(
        command, cwd=folder, env={**_clean(), **ros, "PATH": path}, capture_output=True, text=True, check=False
    )
    if done.returncode:
        sys.exit(f"{' '.join(command)} ended with {done.returncode}:\n{done.stdout[-3000:]}\n{done.stderr[-3000:]}")
    return done.stdout + done.stderr


def _clean() -> dict[str, str]:
    """The environment without what this one's ROS has put into it."""
    left_out = ("_ROS_WHEELS_BOOTSTRAP_COMPLETE", "LD_LIBRARY_PATH", "PYTHONPATH", "VIRTUAL_ENV", "AMENT_PREFIX_PATH")
    return {name: value for name, value in os.environ.items() if name not in left_out}


if __name__ == "__main__":
    sys.exit(main())
