"""Whether the real `ros2` and turtlesim are installed, or Spinbook's own take their place."""

from __future__ import annotations

import shutil

from spinbook.doctor.finding import Finding, ok
from spinbook.ros2 import prefixes


def examine(name: str) -> Finding:
    """Look for them. Either way the chapters run, so this is never a fault."""
    ros2 = shutil.which("ros2")
    turtlesim = prefixes.prefix_of("turtlesim", prefixes.installed())
    parts = [
        f"ros2 at {ros2}" if ros2 else "no ros2: Spinbook's own answers (spinbook ros2)",
        f"turtlesim in {turtlesim}" if turtlesim else "no turtlesim: Spinbook's own turtle",
    ]
    return ok(name, "; ".join(parts))
