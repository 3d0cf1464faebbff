"""The same programs over rcl_python and over the compiled module print the same."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from rclpy.impl.implementation_singleton import rclpy_implementation

from rcl_python.pybind import module

PROGRAMS = Path(__file__).with_name("programs")
_OVER_PYTHON = (
    "import sys, runpy; import rcl_python; rcl_python.install(); runpy.run_path(sys.argv[1], run_name='__main__')"
)


def printed(program: Path, *, over_python: bool) -> list[str]:
    """Return what the program prints."""
    command = [sys.executable, *(["-c", _OVER_PYTHON] if over_python else []), os.fspath(program)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=280, check=False)
    assert done.returncode == 0, done.stderr
    return re.sub(r" at 0x[0-9a-f]+", "", done.stdout).splitlines()


def public(thing: object) -> set[str]:
    """Return the names that a class or a module offers."""
    return {name for name in dir(thing) if not name.startswith("_")}


def test_everything_that_the_compiled_module_offers_is_there() -> None:
    compiled, ours = rclpy_implementation, module("rclpy._rclpy_pybind11")
    assert public(compiled) - public(ours) == {"EventsExecutor"}
    for name in public(compiled) - {"EventsExecutor"}:
        thing = getattr(compiled, name)
        if hasattr(thing, "__members__"):
            numbers = {key: int(value) for key, value in thing.__members__.items()}
            assert (
                numbers.items() <= {key: int(value) for key, value in getattr(ours, name).__members__.items()}.items()
            )
        elif isinstance(thing, type):
            assert public(thing) <= public(getattr(ours, name)), name


@pytest.mark.parametrize("program", sorted(PROGRAMS.glob("*.py")), ids=lambda program: program.stem)
def test_a_program_prints_the_same(program: Path, ros_domain: int) -> None:
    ours, real = printed(program, over_python=True), printed(program, over_python=False)
    assert ours == real
