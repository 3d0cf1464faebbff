"""Whether the grader's own middleware is compiled, and loads in place of Fast DDS."""

from __future__ import annotations

import os
import subprocess
import sys

from rmw_lockstep.library import IDENTIFIER, Library, library
from spinbook.doctor.finding import Finding, ok, warning

_WEAKER = (
    "Without it the grader uses Fast DDS and has to infer when a node is done, so a node with threads or sleeps of its "
    "own may get another result each time."
)
_NAME_IT = "import rclpy; print(rclpy.get_rmw_implementation_identifier())"


def examine(name: str) -> Finding:
    """Let rclpy load it in a process of its own, and name it."""
    found = library()
    if not isinstance(found, Library):
        return warning(name, f"not there: {found.reason}", f"{_WEAKER} {found.remedy}")
    trial = _trial(found)
    loaded = trial.stdout.strip()
    if loaded == IDENTIFIER:
        return ok(name, f"{loaded}, {found.folder}")
    lines = trial.stderr.strip().splitlines() or [f"rclpy has loaded {loaded or 'nothing'}"]
    return warning(
        name,
        f"compiled, but it does not load: {lines[-1]}",
        f"{_WEAKER} Compile it again: rm -r {found.folder}; python -m rmw_lockstep.build",
    )


def _trial(found: Library) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, **found.environment(os.environ)}
    return subprocess.run(
        [sys.executable, "-c", _NAME_IT], env=environment, capture_output=True, text=True, check=False
    )
