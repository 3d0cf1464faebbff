"""A trusted program runs to its end, or is ended with everything that it has started."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest

from groundwork.child_process import run_program


def test_what_a_program_prints_and_its_exit_code_are_returned(tmp_path: Path) -> None:
    code = "import os, sys; print(os.getcwd(), os.environ['WORD']); sys.stderr.write('no\\n'); sys.exit(3)"

    done = run_program([sys.executable, "-c", code], 60, cwd=tmp_path, env={**os.environ, "WORD": "yes"})

    assert (done.returncode, done.stdout, done.stderr) == (3, f"{tmp_path} yes\n", "no\n")


def test_a_program_gets_no_input() -> None:
    assert run_program(["cat"], 60).stdout == ""


def test_a_program_that_is_not_there_is_an_oserror() -> None:
    with pytest.raises(FileNotFoundError):
        run_program(["no-such-program"], 60)


def test_a_program_that_takes_too_long_is_killed_with_its_children(tmp_path: Path) -> None:
    file = tmp_path / "children"
    # The second child has left the program's session, as a browser's child processes do.
    script = f"sleep 600 & a=$!; setsid sleep 600 & echo $a $! > {file}.new; mv {file}.new {file}; wait"

    # On a busy machine a shell may need a while to get so far.
    for seconds in (1, 2, 4, 8, 16, 32):
        with pytest.raises(subprocess.TimeoutExpired):
            run_program(["sh", "-c", script], seconds)
        if file.exists():
            break

    children = list(map(int, file.read_text().split()))
    deadline = time.monotonic() + 240
    while any(map(runs, children)):
        assert time.monotonic() < deadline, "they never ended"
        time.sleep(0.02)


def runs(pid: int) -> bool:
    """Return whether a process has not ended yet, whether or not its parent noticed."""
    try:
        return psutil.Process(pid).status() != psutil.STATUS_ZOMBIE
    except psutil.Error:
        return False
