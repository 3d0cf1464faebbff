"""In a real Chromium, the solution of every exercise passes all public checks; one with threads again and again."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from spinbook.browser.files import can_run

ROOT = Path(__file__).resolve().parents[3]
IN_CHROMIUM = Path(__file__).with_name("checks_in_chromium.py")
EXERCISES = sorted(folder.name for folder in (ROOT / "exercises").iterdir() if (folder / "exercise.toml").is_file())

pytestmark = [
    pytest.mark.soak,
    pytest.mark.timeout(900),
    pytest.mark.skipif(not can_run(), reason="set-up could not fetch Pyodide from npm"),
]


def shown(*paths: str) -> dict[str, dict[str, Any]]:
    """What a page shows of each program; all are checked in one worker."""
    done = subprocess.run([sys.executable, str(IN_CHROMIUM), *paths], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    found: dict[str, dict[str, Any]] = json.loads(done.stdout.splitlines()[-1])
    return found


def test_solutions_and_programs_with_threads_pass_all_public_checks() -> None:
    found = shown(*(f"{exercise}/solution.py" for exercise in EXERCISES), "joint_mover/right")
    assert len(found) > len(EXERCISES)
    assert {name: said for name, said in found.items() if not said.get("full")} == {}
