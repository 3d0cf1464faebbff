"""In a real Chromium, the solution of every exercise passes all public checks; one with threads again and again."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from spinbook.browser.files import can_run

ROOT = Path(__file__).resolve().parents[2]
IN_CHROMIUM = Path(__file__).with_name("checks_in_chromium.py")
EXERCISES = sorted(folder.name for folder in (ROOT / "exercises").iterdir() if (folder / "exercise.toml").is_file())

pytestmark = [
    pytest.mark.soak,
    pytest.mark.timeout(900),
    pytest.mark.skipif(not can_run(), reason="set-up could not fetch Pyodide from npm"),
]


def shown(exercise: str, *names: str) -> dict[str, dict[str, Any]]:
    """What a page shows of each program; all are checked in one worker."""
    command = [sys.executable, str(IN_CHROMIUM), exercise, *names]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, check=False)
    assert done.returncode == 0, done.stderr
    found: dict[str, dict[str, Any]] = json.loads(done.stdout.splitlines()[-1])
    return found


@pytest.mark.parametrize("exercise", EXERCISES)
def test_the_solution_passes_all_public_checks(exercise: str) -> None:
    found = shown(exercise, "solution")["solution"]
    assert found.get("full"), found


def test_programs_with_threads_are_checked_one_after_another() -> None:
    right = sorted(file.stem for file in (ROOT / "solutions" / "joint_mover" / "right").glob("*.py"))
    assert [name for name, found in shown("joint_mover", *right).items() if not found.get("full")] == []
