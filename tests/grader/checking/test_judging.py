"""The overhead of judging, and what it reads."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

EXERCISE = Path(__file__).parents[3] / "exercises" / "joint_velocity"

LOADED_BEFORE = """
import signal, sys, threading
from pathlib import Path
from grader.checking.judge import load_pytest
from grader.checking.judge import listed
from grader.exercise import load

def handlers():
    return [signal.getsignal(number) for number in signal.valid_signals()], threading.excepthook, sys.excepthook

exercise, before = load(Path(sys.argv[1])), handlers()
load_pytest()
assert handlers() == before and threading.active_count() == 1, "the process is not as it was"
loaded = set(sys.modules)
listed(exercise)
print(*sorted(name for name in set(sys.modules) - loaded if name.startswith("_pytest")))
"""


def test_a_process_that_has_loaded_pytest_loads_nothing_more_of_it_for_the_checks_and_is_otherwise_as_it_was() -> None:
    run = subprocess.run(
        [sys.executable, "-c", LOADED_BEFORE, str(EXERCISE)], capture_output=True, text=True, timeout=120
    )
    assert run.returncode == 0, run.stderr
    assert run.stdout.strip() == ""


LISTED = """
import sys
from pathlib import Path
from grader.checking.judge import listed
from grader.exercise import load

print(len(listed(load(Path(sys.argv[1])))))
"""


def test_nothing_that_lies_above_an_exercise_is_read(tmp_path: Path) -> None:
    exercise = tmp_path / "exercises" / EXERCISE.name
    shutil.copytree(EXERCISE, exercise)
    for folder in (tmp_path, exercise.parent):
        (folder / "conftest.py").write_text("raise SystemExit('this file is not for the grader')\n")

    run = subprocess.run([sys.executable, "-c", LISTED, str(exercise)], capture_output=True, text=True, timeout=120)

    assert run.returncode == 0, run.stderr
    assert int(run.stdout) > 10
