"""The environment for starting another program from a Python that runs the ROS wheels.

The wheels' `.pth` file re-executes Python once with the wheels' libraries in LD_LIBRARY_PATH, and marks that with
a guard variable. Another Python that inherits the guard skips its own turn and then misses its libraries; a program
of a ROS installation that inherits the libraries gets the wrong ones. So neither is passed on: each program that
needs them sets both for itself.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from pathlib import Path

GUARD = "_ROS_WHEELS_BOOTSTRAP_COMPLETE"


def without_bootstrap(environment: Mapping[str, str]) -> dict[str, str]:
    """A copy of `environment` as it was before this Python's wheels changed it."""
    clean = dict(environment)
    if clean.pop(GUARD, None) is None:
        return clean
    entries = [entry for entry in clean.pop("LD_LIBRARY_PATH", "").split(os.pathsep) if entry]
    kept = [entry for entry in entries if not _from_wheels(Path(entry))]
    if kept:
        clean["LD_LIBRARY_PATH"] = os.pathsep.join(kept)
    return clean


def _from_wheels(folder: Path) -> bool:
    prefix = Path(sys.prefix)
    return folder == prefix / "lib" or (folder.is_relative_to(prefix) and folder.match("ros_*.libs"))
