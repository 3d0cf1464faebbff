"""Each limit ends the program that hits it, says which one it was, and harms no other program."""

from __future__ import annotations

import dataclasses
import os
import socket
import subprocess
from typing import Any

import pytest
from sandbox_runner import Runner

from grader.sandbox import Isolation, Limits
from grader.sandbox.monitor import Monitor, OutputBuffer

MIB = 1024 * 1024
SMALL = Limits(cpu_s=20.0, memory_bytes=1024 * MIB, processes=64, file_bytes=4 * MIB, output_bytes=MIB, wall_s=240.0)


#: Programs that hit each limit without meaning to.
PLAIN = [
    ("cpu", "while True: pass"),
    ("memory", "x = []\nwhile True: x.append(bytearray(1 << 20))"),
    ("processes", "import os\nwhile True: os.fork()"),
    ("file-size", "import os\nf = open(os.environ['HOME'] + '/big', 'wb')\nwhile True: f.write(bytes(1 << 20))"),
    ("output", "while True: print('x' * 1000)"),
    ("wall", "import time\ntime.sleep(3600)"),
]
#: Ways round a limit, as a program may try them.
CUNNING = [
    ("cpu", "import signal\nsignal.signal(signal.SIGXCPU, signal.SIG_IGN)\nwhile True: pass"),
    ("cpu", "import os\nos.fork(); os.fork()\nwhile True: pass"),
    ("memory", "x = bytearray(10 << 30)"),
    ("memory", "import os, time\nfor _ in range(4): os.fork()\nx = b'x' * (99 << 20)\ntime.sleep(60)"),
    ("processes", "import os\nwhile True:\n  try: os.fork()\n  except OSError: pass"),
    ("processes", "import threading, time\nwhile True: threading.Thread(target=time.sleep, args=(60,)).start()"),
    ("output", "import os\nb = b'x' * 65536\nwhile True: os.write(2, b)"),
    ("wall", "import signal, time\nfor n in (1, 2, 15): signal.signal(n, signal.SIG_IGN)\ntime.sleep(99)"),
]


def ends_at(runner: Runner, limit: str, code: str) -> None:
    """Run a program and check that this limit ends it, and no other program."""
    if limit == "processes" and runner.level is Isolation.NONE and not runner.rootless:
        pytest.skip("the kernel does not limit root's processes, and this level leaves the program to root")
    short: dict[str, Any] = {"cpu": {"cpu_s": 0.1}, "wall": {"wall_s": 0.5}, "processes": {"processes": 32}}
    short["memory"] = {"memory_bytes": 640 * MIB}
    limits = dataclasses.replace(SMALL, **short.get(limit, {}))

    run = runner.run(code, limits=limits, timeout_s=280.0)

    assert run.exit is not None
    assert run.exit.limit == limit
    assert run.exit.code != 0
    assert runner.run("print('well')").text == "well\n"


@pytest.mark.parametrize(("limit", "code"), PLAIN)
def test_a_limit_ends_the_program_and_is_reported(any_runner: Runner, limit: str, code: str) -> None:
    ends_at(any_runner, limit, code)


@pytest.mark.parametrize(("limit", "code"), CUNNING)
def test_cunning_gets_round_no_limit(strongest_runner: Runner, limit: str, code: str) -> None:
    ends_at(strongest_runner, limit, code)


@pytest.mark.soak
@pytest.mark.parametrize(("limit", "code"), CUNNING)
def test_cunning_gets_round_no_limit_at_any_level(any_runner: Runner, limit: str, code: str) -> None:
    ends_at(any_runner, limit, code)


@pytest.mark.parametrize("place", ["HOME", "TMPDIR", "/dev/shm"])
def test_many_small_files_fill_nothing_but_their_own_place(apart_runner: Runner, place: str) -> None:
    code = f"""
import os
place = os.environ.get({place!r}, {place!r})
written = 0
try:
    for n in range(10000):
        with open(f'{{place}}/{{n}}', 'wb', buffering=0) as file:
            written += file.write(bytes(100_000))
finally:
    print(written, flush=True)
"""
    run = apart_runner.run(code, limits=SMALL)

    assert int(run.text.splitlines()[0]) <= SMALL.file_bytes
    assert run.exit is not None
    assert run.exit.limit == "file-size"


def test_no_core_file_is_written(confined_runner: Runner) -> None:
    code = "import os, resource\nprint(resource.getrlimit(resource.RLIMIT_CORE))"

    assert confined_runner.run(code).text == "(0, 0)\n"


def test_a_program_cannot_raise_its_limits(confined_runner: Runner) -> None:
    code = """
import resource
for which in (resource.RLIMIT_AS, resource.RLIMIT_NPROC, resource.RLIMIT_FSIZE, resource.RLIMIT_NOFILE):
    try:
        resource.setrlimit(which, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
        print('raised', which)
    except ValueError:
        pass
"""
    assert confined_runner.run(code).text == ""


@pytest.mark.parametrize("values", [{"memory_bytes": 100 * MIB}, {"processes": 12}])
def test_limits_in_which_rclpy_hangs_are_refused(values: dict[str, int]) -> None:
    with pytest.raises(ValueError, match="rclpy"):
        dataclasses.replace(Limits(), **values)


def test_the_first_and_the_last_part_of_much_output_is_kept(any_runner: Runner) -> None:
    code = "print('first')\nfor n in range(40000): print('line', n)\nprint('last')"

    text = any_runner.run(code).text

    assert text.startswith("first\nline 0\n")
    assert text.endswith("line 39999\nlast\n")
    assert "bytes of output are not shown" in text
    assert len(text) < 140_000


def test_what_was_printed_is_known_at_once() -> None:
    control, supervisor = socket.socketpair()
    output, printed = os.pipe()
    program = subprocess.Popen(["sleep", "60"])
    monitor = Monitor(control, output, SMALL, program.pid, program.pid, frozenset())
    known = []
    for _ in range(300):  # the monitor's own thread reads it, too, but needs a moment
        os.write(printed, b"x")
        known.append(len(monitor.output()))
    supervisor.close()  # the monitor then kills the program
    os.close(printed)
    program.wait()
    monitor.join()
    assert known == list(range(1, 301))


def test_all_output_is_counted_whatever_the_pieces() -> None:
    buffer = OutputBuffer()
    pieces = [bytes([97 + n % 26]) * n for n in range(1, 900)]
    for piece in pieces:
        buffer.add(piece)

    whole = b"".join(pieces).decode()
    gap = f"\n[... {len(whole) - 2 * 65536} bytes of output are not shown ...]\n"
    assert buffer.text() == whole[:65536] + gap + whole[-65536:]


def test_a_student_whose_output_nobody_wants_is_not_held_up(any_runner: Runner) -> None:
    # 8 MiB go through a pipe that holds 64 KiB, and the program ends by itself.
    run = any_runner.run("import os\nfor _ in range(128): os.write(1, bytes(65536))\nos._exit(4)")

    assert run.exit is not None
    assert (run.exit.code, run.exit.limit) == (4, None)
