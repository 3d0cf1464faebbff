"""Every hostile submission, run against a real publisher in its sandbox: none escapes, and the runner is unharmed.

What the grader makes of them is tested in tests/grader/hostile; this file only tests the sandbox.
"""

from __future__ import annotations

import os
import time
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import psutil
import pytest
from sandbox_runner import Runner
from submissions import HONEST, SUBMISSIONS

from grader.exercise import Exercise, load
from grader.recording.recording import RunOutcome
from grader.runner.program import RunningProgram as RunningProgram
from grader.runner.program import Task
from grader.runner.run import run
from grader.sandbox import ForkServer, Isolation, Limits, ProgramSpec
from grader.scenario import Scenario
from grader.scenario.command_line import arguments
from grader.scenario.declared import declared
from grader.workers.pool import STUDENT_ENVIRONMENT

ROOT = Path(__file__).parents[3]
LIMITS = Limits(cpu_s=2.0, output_bytes=4 << 20, file_bytes=16 << 20, processes=96, wall_s=90.0)
# The folders that are watched for files that a student has left.
WATCHED = (Path("/tmp"), Path("/dev/shm"), Path("/var/tmp"), Path.home(), HONEST.parent, ROOT)
# Attacks on the machine are tried at every level; others (on the grading, or on nothing) at the strongest only.
EVERYWHERE = {
    *("fork_bomb_in_the_callback", "imports_the_grader", "kills_everything", "kills_its_parent", "log_1_gb"),
    *("looks_for_solutions", "memory_in_many_processes", "outlives_by_double_fork", "ptraces_others"),
    *("raises_its_limits", "reads_proc_of_others", "remembers_between_runs", "stops_itself", "writes_everywhere"),
    *("writes_to_every_descriptor",),
}
# One of each kind, for every `make test`; test_nothing_is_left.py kills all that it can at every level.
# `make soak` runs all.
ALWAYS = {
    *("disk_in_many_files", "escapes_by_namespaces", "fork_bomb_in_the_callback"),
    *("log_1_gb", "memory_10_gb", "network_access"),
    *("outlives_by_double_fork", "random_packets", "remembers_between_runs", "writes_everywhere"),
}


@dataclass(frozen=True)
class Spun:
    """What a submission did: how its run ended, what it printed, how many answers it sent, what it left running."""

    outcome: RunOutcome
    text: str
    answers: int
    left_running: int


#: How long to wait until what has been killed is gone (s).
DEADLINE_S = 60.0


@cache
def exercise_and_scenario() -> tuple[Exercise, Scenario]:
    exercise = load(ROOT / "exercises" / "joint_velocity")
    return exercise, declared(exercise, 1)[0]


def spin(fork_server: ForkServer, level: Isolation, source: bytes) -> Spun:
    """In the runner: run a submission through the exercise's first scenario, which ends with Ctrl-C."""
    exercise, scenario = exercise_and_scenario()
    file = exercise.file_name

    def start(hub: int) -> RunningProgram:
        program = ProgramSpec(file, {file: source}, arguments(scenario), STUDENT_ENVIRONMENT, hub=hub)
        return fork_server.start(program, level, LIMITS, core=0)

    recording = run(Task(exercise, scenario, file, source.decode(errors="replace")), start)
    # Only the fork server itself must be left of all that it has started, once our own supervisor has ended.
    deadline = time.monotonic() + DEADLINE_S
    while (left := len(psutil.Process(os.getpid()).children(recursive=True)) - 1) and time.monotonic() < deadline:
        time.sleep(0.001)
    return Spun(recording.ending.outcome, recording.log, len(recording.received), left)


def files() -> set[Path]:
    """Return what is in the watched folders, except what tests and Python make there."""
    ours = ("pytest", "spinbook-", "nobody-", "hidden-checks-", "course-", "tmp", "pymp-", "sem.", ".", "fastrtps_")
    return {path for folder in WATCHED for path in folder.iterdir() if not path.name.startswith(ours)}


def over_limit(name: str) -> bool:
    """Return whether a submission is expected to hit a limit."""
    return SUBMISSIONS[name].outcome == ("over-limit",)


def spin_and_look(runner: Runner, name: str) -> Spun:
    """Run a submission, and check what is true for each of them."""
    before = files()
    spun: Spun = runner.do(spin, SUBMISSIONS[name].source.encode())

    for word in SUBMISSIONS[name].never:
        assert word not in spun.text
    left = [path for path in files() - before if path.name.startswith(("written_by_a", "note-of-an", "results.json"))]
    assert left == []
    assert spun.left_running == 0
    honest: Spun = runner.do(spin, HONEST.read_bytes())
    assert honest.answers > 0
    return spun


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=() if name in ALWAYS else pytest.mark.soak) for name in sorted(SUBMISSIONS)]
)
def test_a_hostile_submission_is_contained(strongest_runner: Runner, name: str) -> None:
    spun = spin_and_look(strongest_runner, name)

    assert spun.outcome == "over-limit" or not over_limit(name), spun.text
    if SUBMISSIONS[name].score == "full":
        assert spun.answers > 0, spun.text


@pytest.mark.soak
@pytest.mark.parametrize("name", sorted(EVERYWHERE))
def test_an_attack_on_the_machine_is_contained_at_every_level(confined_runner: Runner, name: str) -> None:
    spin_and_look(confined_runner, name)
