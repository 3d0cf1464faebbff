"""Blocked time counts only while nothing that a program needs could run: not while the machine owes it a turn."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace

import pytest

from grader.runner.budget import BLOCKED_IN_ALL, Allowance, Budget
from grader.runner.program import CannotContinue

#: A program that sleeps, with a thread of liblockstep's name that always has something to do. With `idle` as its
#: argument, that thread gets a CPU only while nothing else wants it. With `kernel` and a pipe it waits inside the
#: kernel, for a child that can't start before somebody opens the pipe.
SLEEPS = """
import ctypes, os, signal, sys, threading

def supervise():
    ctypes.CDLL(None).prctl(15, b'lockstep')
    if 'idle' in sys.argv:
        os.sched_setscheduler(0, os.SCHED_IDLE, os.sched_param(0))
    print('ready', flush=True)
    if 'kernel' in sys.argv:
        os.posix_spawn('/bin/true', ['true'], {}, file_actions=[(os.POSIX_SPAWN_OPEN, 0, sys.argv[-1], os.O_RDONLY, 0)])
    while True:
        pass

sys.setswitchinterval(1000)
threading.Thread(target=supervise).start()
ctypes.CDLL(None).pause()
"""


def budget_of(pid: int) -> Budget:
    """Return the budget of a process, looked at once, so that every further look counts."""
    student = SimpleNamespace(pid=pid, poll=lambda: None, cpu_seconds=lambda: 0.0, at_limit=lambda: False)
    budget = Budget(student, lambda: {pid}, Allowance("busy", "blocked", blocked_s=1000.0))
    budget.look()
    return budget


@contextmanager
def sleeping(*arguments: str) -> Iterator[int]:
    """The process id of the program that sleeps, on the same core as this process."""
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(before)})
    process = subprocess.Popen([sys.executable, "-c", SLEEPS, *arguments], stdout=subprocess.PIPE)
    try:
        assert process.stdout
        process.stdout.readline()
        yield process.pid
    finally:
        process.kill()
        process.communicate()
        os.sched_setaffinity(0, before)


def test_a_program_that_has_ended_is_not_blocked_while_nobody_has_noticed() -> None:
    ended = subprocess.Popen(["true"])
    os.waitid(os.P_PID, ended.pid, os.WEXITED | os.WNOWAIT)
    budget = budget_of(ended.pid)
    for _ in range(3):
        budget.look()
    ended.wait()
    for _ in range(3):
        time.sleep(0.001)
        budget.look()
    assert budget.blocked == 0


def test_a_program_is_not_blocked_while_the_thread_that_hands_it_its_time_waits_for_a_cpu(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    with sleeping("idle") as pid:
        budget = budget_of(pid)
        now = [time.monotonic()]
        monkeypatch.setattr(time, "monotonic", lambda: now[0])
        for _ in range(100):  # this process takes the core meanwhile
            now[0] += 0.02
            budget.look()
    assert budget.blocked < 1.0, "of 2 s: it may have had a turn or two"


def states(pid: int) -> set[str]:
    """Return the states of a process's threads."""
    return {file.read_text().rpartition(") ")[2][0] for file in Path(f"/proc/{pid}/task").glob("*/stat")}


def test_a_program_is_not_blocked_while_the_kernel_makes_that_thread_wait(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    with sleeping("kernel", str(tmp_path / "pipe")) as pid:
        while states(pid) != {"S", "D"}:
            os.sched_yield()
        budget = budget_of(pid)
        for _ in range(30):
            time.sleep(0.002)
            budget.look()
        (tmp_path / "pipe").write_text("")  # lets the child start, and end
    assert budget.blocked == 0


def test_a_program_whose_only_ready_thread_has_had_its_turn_is_blocked() -> None:
    deadline = time.monotonic() + 60
    with sleeping() as pid:
        budget = budget_of(pid)
        while budget.blocked < 0.05 and time.monotonic() < deadline:
            time.sleep(0.002)
            budget.look()
    assert budget.blocked >= 0.05


def test_a_program_may_not_be_blocked_for_a_while_in_each_step_of_a_run(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [time.monotonic()]
    monkeypatch.setattr(time, "monotonic", lambda: now[0])
    with subprocess.Popen(["sleep", "600"]) as sleeper:
        budget = budget_of(sleeper.pid)

        def steps() -> None:
            for look in range(1_000):
                if not look % 50:
                    budget.begin(Allowance("busy", "blocked"))
                now[0] += 0.02
                budget.look()

        with pytest.raises(CannotContinue) as stopped:
            steps()
        sleeper.kill()
    assert (stopped.value.outcome, stopped.value.message) == ("timed-out", BLOCKED_IN_ALL)
