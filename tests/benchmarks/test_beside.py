"""`make course` grades a class beside its other steps: in which order their output comes, and how they end."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = [sys.executable, str(Path(__file__).parents[2] / "benchmarks" / "class" / "beside.py")]
#: Says its process's number, and waits for a signal.
WAITS = "sh -c 'echo $$ > {}; exec sleep 60'"


def run(*commands: str) -> tuple[int, list[str]]:
    done = subprocess.run([*PROGRAM, *commands], capture_output=True, text=True, timeout=60, check=False)
    return done.returncode, done.stdout.splitlines()


def has_ended(number: Path) -> bool:
    return not Path("/proc", number.read_text().strip()).exists()


def test_the_output_of_the_command_comes_after_that_of_the_steps() -> None:
    command = "sh -c 'echo first; exit 4'"
    assert run(command, "echo a", "sleep 0.1", "echo b") == (
        4,
        ["echo a", "a", "sleep 0.1", "echo b", "b", command, "first"],
    )


def test_a_step_that_fails_ends_everything_and_is_named_last(tmp_path: Path) -> None:
    command = WAITS.format(tmp_path / "number")
    step = f"sh -c 'until [ -s {tmp_path}/number ]; do sleep 0.01; done; exit 3'"
    code, lines = run(command, step, "echo never")
    assert (code, lines) == (3, [step, f"`{step}` ended with 3, so the rest was stopped: {command}"])
    assert has_ended(tmp_path / "number")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM], ids=lambda number: number.name)
def test_a_signal_ends_everything(tmp_path: Path, number: signal.Signals) -> None:
    files = [tmp_path / "command", tmp_path / "step"]
    told = f"sh -c 'until [ -s {files[0]} ]; do sleep 0.01; done; echo $$ > {files[1]}; echo started; exec sleep 60'"
    with subprocess.Popen(
        [*PROGRAM, WAITS.format(files[0]), told], stdout=subprocess.PIPE, text=True, start_new_session=True
    ) as process:
        assert process.stdout
        assert [process.stdout.readline(), process.stdout.readline()] == [f"{told}\n", "started\n"]
        # A terminal sends Ctrl-C to all of them.
        send = process.send_signal if number == signal.SIGTERM else lambda sent: os.killpg(process.pid, sent)
        send(number)
        assert process.wait(30) == 128 + number
    assert all(map(has_ended, files))
