"""A trusted program runs to its end, or is ended with everything that it has started."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from process_tree import runs
from small_class import wait_until

from grader.child_process import run_program


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
    wait_until(lambda: not any(map(runs, children)))
