"""Where no Python is named, set-up takes `python3`, or a build of its version that was compiled with optimizations."""

from __future__ import annotations

import json
import os
import subprocess
from dataclasses import asdict, replace
from pathlib import Path

import pytest
from setup_stage import REAL_PYTHON, ROOT, Checkout

from spinbook.doctor.python_build import PythonBuild, faster_build, this_build

SLOW = PythonBuild("/home/me/.pyenv/bin/python3", "3.11", optimized=False, complete=True)
FAST = PythonBuild("/usr/bin/python3.11", "3.11", optimized=True, complete=True)


def python_in(folder: Path, text: str) -> str:
    """Put a `python3.11` into a folder; return the folder, for PATH."""
    folder.mkdir()
    program = folder / "python3.11"
    program.write_text(f"#!/bin/sh\n{text}\n")
    program.chmod(0o755)
    return os.fspath(folder)


def described(folder: Path, build: PythonBuild) -> str:
    return python_in(folder, f"echo '{json.dumps(asdict(build))}'")


def test_a_faster_build_of_the_same_version_is_found_wherever_it_is_on_the_path(tmp_path: Path) -> None:
    slow, fast = described(tmp_path / "slow", SLOW), described(tmp_path / "fast", FAST)
    assert faster_build(SLOW, f"{tmp_path}/none:{slow}:{fast}") == "/usr/bin/python3.11"


def test_the_first_of_several_is_taken(tmp_path: Path) -> None:
    first = described(tmp_path / "first", replace(FAST, executable="/opt/python3.11"))
    second = described(tmp_path / "second", FAST)
    assert faster_build(SLOW, f"{first}:{second}") == "/opt/python3.11"


def test_an_optimized_python_needs_no_other(tmp_path: Path) -> None:
    other = described(tmp_path / "fast", FAST)
    assert faster_build(replace(SLOW, optimized=True), other) is None


def test_another_version_is_not_taken(tmp_path: Path) -> None:
    assert faster_build(replace(SLOW, version="3.12"), described(tmp_path / "fast", FAST)) is None


@pytest.mark.parametrize("other", [replace(FAST, optimized=False), replace(FAST, complete=False)])
def test_one_that_is_no_better_or_lacks_venv_or_headers_is_passed_over(tmp_path: Path, other: PythonBuild) -> None:
    assert faster_build(SLOW, described(tmp_path / "other", other)) is None


@pytest.mark.parametrize(
    "text", ["echo 'pyenv: python3.11: command not found' >&2; exit 127", "echo '{}'", "echo '[]'", "echo hello"]
)
def test_one_that_does_not_answer_is_passed_over(tmp_path: Path, text: str) -> None:
    broken, fast = python_in(tmp_path / "broken", text), described(tmp_path / "fast", FAST)
    assert faster_build(SLOW, broken) is None
    assert faster_build(SLOW, f"{broken}:{fast}") == FAST.executable


def test_a_python_describes_itself_before_anything_is_installed() -> None:
    program = ROOT / "spinbook" / "doctor" / "python_build.py"
    answer = subprocess.run([REAL_PYTHON, "-I", program, "--describe"], capture_output=True, text=True, check=True)
    # This environment was made from it, so all that is needed for one is there.
    assert PythonBuild(**json.loads(answer.stdout)) == replace(this_build(), complete=True)


# What set-up does with it


def add_faster_build(checkout: Checkout) -> str:
    """Let the simulated `python3` find a faster build; return where that is."""
    checkout.program("faster-python", checkout.python.read_text().replace("venv $3", "venv $3, faster"))
    build = f"{checkout.stage}/bin/faster-python"
    checkout.tell("faster-build", f"{build}\n")
    return build


def test_the_environment_is_made_from_the_faster_build_and_that_is_said(checkout: Checkout) -> None:
    build = add_faster_build(checkout)
    code, said = checkout.set_up(PYTHON="")
    assert code == 0, said
    assert checkout.calls[0] == "venv .venv, faster"
    assert f"This uses {build}" in said
    assert "make PYTHON=python3" in said
    assert checkout.set_up(PYTHON="") == (0, "")


def test_a_python_that_is_named_is_used_whatever_else_there_is(checkout: Checkout) -> None:
    add_faster_build(checkout)
    code, said = checkout.set_up(PYTHON="python3")
    assert code == 0, said
    assert checkout.calls[0] == "venv .venv"
    assert "faster" not in said


def test_an_environment_that_is_there_keeps_its_python(checkout: Checkout) -> None:
    checkout.set_up(PYTHON="")
    add_faster_build(checkout)
    checkout.forget_calls()
    assert checkout.set_up(PYTHON="") == (0, "")
    assert checkout.calls == []
