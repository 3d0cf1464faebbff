"""Whether rclpy can write its log files, without which `rclpy.init` raises."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from spinbook.doctor.finding import Finding, missing, ok, warning


def examine(name: str) -> Finding:
    """Write a file where ROS 2 would: ROS_LOG_DIR, else ROS_HOME/log, else ~/.ros/log."""
    chosen, variable = _place()
    if chosen is None:
        return _fallback(name, "HOME is not set")
    existing = next(place for place in (chosen, *chosen.parents) if place.exists())
    try:
        with tempfile.TemporaryFile(dir=existing):
            return ok(name, f"{chosen} ({variable})")
    except OSError as error:
        reason = f"{chosen} ({variable}) can't be written: {error.strerror}"
    if variable != "HOME":
        return missing(
            name, reason, f"rclpy.init would fail. Set {variable} to a folder that you can write, or unset it."
        )
    return _fallback(name, reason)


def _place() -> tuple[Path | None, str]:
    if folder := os.environ.get("ROS_LOG_DIR"):
        return Path(folder).expanduser().absolute(), "ROS_LOG_DIR"
    if folder := os.environ.get("ROS_HOME"):
        return Path(folder).expanduser().absolute() / "log", "ROS_HOME"
    if folder := os.environ.get("HOME"):
        return Path(folder).absolute() / ".ros" / "log", "HOME"
    return None, "HOME"


def _fallback(name: str, reason: str) -> Finding:
    """Notebooks and `spinbook ros2` then write below the folder for temporary files, if that can be written."""
    try:
        with tempfile.TemporaryFile():
            pass
    except OSError as error:
        return missing(
            name, f"{reason}; nor can {tempfile.gettempdir()}: {error.strerror}", "Make one of them writable."
        )
    return warning(
        name,
        f"{reason}; Spinbook uses {tempfile.gettempdir()} instead",
        "Your own nodes in a terminal fail at rclpy.init: export ROS_LOG_DIR=/tmp/ros-log",
    )
