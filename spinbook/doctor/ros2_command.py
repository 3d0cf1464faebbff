"""Whether the real `ros2` and turtlesim's window are installed, or Spinbook's own take their place."""

from __future__ import annotations

import os

from spinbook.doctor.finding import Finding, ok
from spinbook.ros2 import prefixes
from spinbook.ros2.executables import is_built_in
from spinbook.ros2.real import real_ros2


def examine(name: str) -> Finding:
    """Look for them. Either way the chapters run, so this is never a fault."""
    ros2 = real_ros2([], os.environ)
    prefix = prefixes.prefix_of("turtlesim", prefixes.installed())
    turtlesim = None if is_built_in("turtlesim", prefix) else prefix
    parts = [
        f"ros2 at {ros2[0]}" if ros2 else "no ros2: Spinbook's own answers (ros2, spinbook ros2)",
        f"turtlesim in {turtlesim}" if turtlesim else "turtlesim's nodes: Spinbook's own",
    ]
    return ok(name, "; ".join(parts))
