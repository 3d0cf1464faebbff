"""`ros2` does over rcl_python what it does over the compiled module: the same tests pass."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from hub_of_processes import hub

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[3]
#: What can't be the same, and why. The list may only get shorter.
EXPECTED: dict[str, str] = {}


@pytest.mark.soak
@pytest.mark.timeout(1800)
def test_the_tests_of_ros2_pass_over_rcl_python(tmp_path: Path) -> None:
    command = [
        sys.executable,
        "-m",
        "pytest",
        "-q",
        "-p",
        "pytest_timeout",
        "-p",
        "xdist.plugin",
        "-rf",
        "packages/ros_in_python/tests/ros2",
    ]
    with hub(tmp_path) as joining:
        environment = {**os.environ, **joining, "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
        done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=1700)
    failed = set(re.findall(r"^(?:FAILED|ERROR) \S+::(\w+)", done.stdout, re.MULTILINE))
    assert failed == set(EXPECTED), done.stdout[-8000:]
    assert re.search(r"\d+ passed", done.stdout), done.stdout[-2000:]
