"""Whether LD_LIBRARY_PATH leads to the libraries of the ROS 2 that is used, and to no other.

The wheels set it themselves: their .pth file starts Python a second time with it, and marks that with a guard
variable. Where the guard is inherited without the path, or from another environment, the second start is skipped.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path

from spinbook.doctor.finding import Finding, missing, ok, warning
from spinbook.doctor.ros_library import wheels_installed
from spinbook.ros2.bootstrap import GUARD


def examine(name: str) -> Finding:
    """Compare LD_LIBRARY_PATH with where this environment's libraries are."""
    entries = [Path(entry) for entry in os.environ.get("LD_LIBRARY_PATH", "").split(os.pathsep) if entry]
    with_ros = list(dict.fromkeys(entry for entry in entries if (entry / "librcl.so").exists()))
    own = Path(sys.prefix, "lib")
    if not wheels_installed():
        return ok(name, ", ".join(map(str, with_ros)) or "no ROS libraries on it")
    if own not in entries:
        return missing(
            name,
            f"{GUARD} is set, but LD_LIBRARY_PATH does not name {own}",
            f"Something dropped LD_LIBRARY_PATH and kept the guard. Drop both: unset {GUARD} LD_LIBRARY_PATH",
        )
    others = [str(entry) for entry in with_ros if entry != own]
    if others:
        return warning(
            name,
            f"{own}, and also {', '.join(others)}",
            "Libraries of another ROS may be loaded. Use a terminal in which neither another environment is active nor "
            f"a ROS setup file is sourced, or: unset {GUARD} LD_LIBRARY_PATH",
        )
    return ok(name, f"{own}, set by the wheels themselves")
