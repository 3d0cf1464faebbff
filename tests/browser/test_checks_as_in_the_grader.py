"""A check in the page records and says what the real grader's public part does, for every solution and mistake."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
IN_BOTH = Path(__file__).with_name("checks_in_both.py")
#: What every `make test` goes through; `make soak` goes through all.
ALWAYS = ("solution", "degrees", "several_threads")
EXERCISES = sorted(folder.name for folder in (ROOT / "exercises").iterdir() if (folder / "exercise.toml").is_file())
#: A page can't run these, and says so.
NEEDS_MORE = {
    "joint_velocity": {"asyncio_loop", "numpy_arrays"},
    "joint_filter": {"numpy_arrays"},
}


def found(exercise: str, *names: str) -> dict[str, str]:
    """What the comparison says of each program."""
    command = [sys.executable, os.fspath(IN_BOTH), exercise, *names]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, check=False)
    assert done.returncode == 0, done.stderr
    said: dict[str, str] = json.loads(done.stdout.splitlines()[-1])
    return said


def differing(exercise: str, said: dict[str, str]) -> dict[str, str]:
    """The programs that differ, without those that a page refuses to run, as it should."""
    refused = {name for name, words in said.items() if words.startswith("not checked: ")}
    assert refused == NEEDS_MORE.get(exercise, set()) & set(said)
    return {name: words for name, words in said.items() if words != "same" and name not in refused}


def test_a_check_in_the_page_comes_to_the_same() -> None:
    assert differing("joint_velocity", found("joint_velocity", *ALWAYS)) == {}


@pytest.mark.soak
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("exercise", EXERCISES)
def test_every_check_in_the_page_comes_to_the_same(exercise: str) -> None:
    assert differing(exercise, found(exercise)) == {}
