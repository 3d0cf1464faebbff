"""When a student's program is killed, or its runner dies, all of its processes and files are gone."""

from __future__ import annotations

import os
import time
import uuid
from pathlib import Path

import psutil
import pytest
from sandbox_runner import Runner, reason_against

from grader.sandbox import ForkServer, Isolation, ProcessExit, ProgramSpec

#: Says that its daemons started only when the last of them has said so, in a pipe: it may end right after.
DAEMON = """
import ctypes, os, signal, sys, time
ctypes.CDLL(None).prctl(15, {name!r}.encode(), 0, 0, 0)
for number in (1, 2, 3, 15, 10, 12):
    signal.signal(number, signal.SIG_IGN)
started, says = os.pipe()
for depth in range(3):
    if os.fork():
        continue
    os.setsid()
    if os.fork():
        os._exit(0)
    os.close(1)
    os.write(says, b'.')
    while True:
        time.sleep(3600)
for depth in range(3):
    os.read(started, 1)
print('daemons started', flush=True)
"""


def alive(name: str) -> int:
    """Return how many processes of this machine have a name."""
    return sum(process.info["name"] == name for process in psutil.process_iter(["name"]))


def start_daemons(
    fork_server: ForkServer, level: Isolation, name: str, end: str
) -> tuple[ProcessExit | None, int, int]:
    """Start daemons that ignore every signal, and kill them; return how many there were before and after.

    Where the program ends by itself, those before are counted while others end.
    """
    code = DAEMON.format(name=name) + end
    with fork_server.start(ProgramSpec("d.py", {"d.py": code.encode()}), level) as student:
        while "started" not in student.output():
            time.sleep(0.001)
        before = len(student.members())
        if "exit" in end:
            student.wait(30.0)
    return student.poll(), before, len(student.members())


@pytest.mark.parametrize("end", ["signal.pause()", "os._exit(0)"])
def test_daemons_do_not_outlive_a_killed_program(any_runner: Runner, end: str) -> None:
    name = f"d{uuid.uuid4().hex[:12]}"

    ended, before, after = any_runner.do(start_daemons, name, end)

    assert before >= 3 or "exit" in end
    assert after == 0
    assert alive(name) == 0
    assert ended == (ProcessExit(0, None, None) if "exit" in end else ProcessExit(None, 9, None))


def test_a_program_that_kills_all_that_it_can_see_kills_only_itself(confined_runner: Runner) -> None:
    code = """
import os, signal
for target in (-1, 0, os.getppid(), 1, *range(2, 40000)):
    if target == os.getpid():
        continue
    try:
        os.kill(target, signal.SIGKILL)
    except (OSError, ProcessLookupError):
        pass
print('survived')
"""
    confined_runner.run(code)

    assert confined_runner.run("print('the runner lives')").text == "the runner lives\n"


def start_and_stay(fork_server: ForkServer, level: Isolation, name: str) -> None:
    """Leave a program with daemons running in the runner."""
    student = fork_server.start(
        ProgramSpec("d.py", {"d.py": (DAEMON.format(name=name) + "signal.pause()").encode()}), level
    )
    while "started" not in student.output():
        time.sleep(0.001)
    _kept.append(student)


_kept: list[object] = []


@pytest.mark.parametrize("level", list(Isolation))
def test_when_the_rig_is_killed_its_student_dies_with_it(level: Isolation, any_level_works: None) -> None:
    name = f"r{uuid.uuid4().hex[:12]}"
    runner = Runner(level, rootless=False)
    try:
        runner.do(start_and_stay, name)
        assert alive(name) >= 3
    finally:
        runner.kill()

    deadline = time.monotonic() + 60
    while alive(name):
        assert time.monotonic() < deadline, "the student outlives its runner"
        time.sleep(0.01)


@pytest.fixture
def any_level_works(level: Isolation) -> None:
    """Skip a level that this machine does not allow."""
    reason = reason_against(level, False)
    if reason is not None:
        pytest.skip(f"{level}: {reason}")


def test_no_temporary_folder_is_left(any_runner: Runner) -> None:
    def folders() -> set[str]:
        return {path.name for path in Path("/tmp").glob("spinbook-student-*")}

    shown = any_runner.run("import os\nprint(os.path.dirname(os.path.dirname(__file__)))").text.strip()

    assert Path(shown).name not in folders() or shown == "/"


@pytest.mark.parametrize("times", [10, pytest.param(200, marks=pytest.mark.soak)])
def test_many_programs_leave_nothing(any_runner: Runner, times: int) -> None:
    name = f"m{uuid.uuid4().hex[:12]}"
    before = any_runner.do(resources)
    for _ in range(times):
        any_runner.do(start_and_kill, name)

    # A thread that has been joined is listed until the kernel has removed it; a leak stays.
    deadline = time.monotonic() + 60
    while (after := any_runner.do(resources)) != before and time.monotonic() < deadline:
        time.sleep(0.01)
    assert after == before
    assert alive(name) == 0


def start_and_kill(fork_server: ForkServer, level: Isolation, name: str) -> None:
    code = f"import ctypes, time\nctypes.CDLL(None).prctl(15, {name!r}.encode(), 0, 0, 0)\ntime.sleep(60)"
    fork_server.start(ProgramSpec("s.py", {"s.py": code.encode()}), level).kill()


def resources(fork_server: ForkServer, level: Isolation) -> tuple[int, int, int]:
    """Return open files, threads and mounts of the runner."""
    me = psutil.Process()
    return me.num_fds(), me.num_threads(), len(Path("/proc/self/mounts").read_text().splitlines())


def sockets_of_helpers(fork_server: ForkServer, level: Isolation) -> tuple[int, list[str]]:
    """Count the processes that keep a program's sandbox open, and return the sockets that these have."""
    with fork_server.start(ProgramSpec("p.py", {"p.py": b"import signal; signal.pause()"}), level) as student:
        program = psutil.Process(student.pid)
        supervisor = program.parent()
        assert supervisor is not None
        helpers = [process for process in supervisor.children(recursive=True) if process != program]
        files = [file for helper in helpers for file in Path(f"/proc/{helper.pid}/fd").iterdir()]
        return len(helpers), [target for file in files if (target := str(file.readlink())).startswith("socket:")]


@pytest.mark.skipif(os.geteuid() != 0, reason="only root sees what files the processes of a sandbox have open")
def test_what_keeps_a_sandbox_open_holds_no_socket_of_the_grader(strongest_runner: Runner) -> None:
    _, sockets = strongest_runner.do(sockets_of_helpers)

    assert sockets == []
