"""The environment in which a notebook's processes run: their ROS domain, this machine only, logs that can be read."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Mapping
from pathlib import Path

from spinbook.ros2 import prefixes

LOOPBACK_PROFILE = Path(__file__).with_name("loopback.xml")
#: No time stamps: the same log from build to build.
LOG_FORMAT = "[{severity}] [{name}]: {message}"
#: Set while a notebook is executed by `spinbook build`: nobody watches, so plots are drawn once.
EXECUTING = "SPINBOOK_EXECUTING"
#: Names a file into which a notebook writes its ROS domain, for whoever watches it.
DOMAIN_NOTE = "SPINBOOK_DOMAIN_NOTE"


def for_domain(domain: int, environment: Mapping[str, str]) -> dict[str, str]:
    """What to set so that ROS processes talk in `domain`, and with this machine only.

    Fast DDS (the default) gets a profile that speaks UDP on 127.0.0.1; other middlewares are told LOCALHOST.
    """
    is_fast_dds = environment.get("RMW_IMPLEMENTATION", "rmw_fastrtps_cpp").startswith("rmw_fastrtps")
    settings = {
        "ROS_DOMAIN_ID": str(domain),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "SYSTEM_DEFAULT" if is_fast_dds else "LOCALHOST",
        "RCUTILS_CONSOLE_OUTPUT_FORMAT": environment.get("RCUTILS_CONSOLE_OUTPUT_FORMAT", LOG_FORMAT),
        "RCUTILS_COLORIZED_OUTPUT": environment.get("RCUTILS_COLORIZED_OUTPUT", "0"),
        # Jupyter asks for colours of every program; Python obeys from 3.13 on.
        "PYTHON_COLORS": environment.get("PYTHON_COLORS", "0"),
        "PYTHONUNBUFFERED": "1",
    }
    if is_fast_dds:
        settings["FASTRTPS_DEFAULT_PROFILES_FILE"] = os.fspath(LOOPBACK_PROFILE)
        settings["FASTDDS_DEFAULT_PROFILES_FILE"] = os.fspath(LOOPBACK_PROFILE)
    if "HOME" not in environment:
        # rclpy.init raises without one, even where ROS_LOG_DIR is set.
        settings["HOME"] = tempfile.gettempdir()
    if "ROS_LOG_DIR" not in environment and not _home_is_writable(environment):
        # It raises too where it can't write its log files.
        settings["ROS_LOG_DIR"] = os.fspath(Path(tempfile.gettempdir()) / f"spinbook-ros-log-{os.getuid()}")
    return settings


def _home_is_writable(environment: Mapping[str, str]) -> bool:
    home = environment.get("HOME")
    return bool(home) and os.access(home or "", os.W_OK)


def missing_middleware(environment: Mapping[str, str]) -> str | None:
    """The middleware that RMW_IMPLEMENTATION names, if it is not installed here.

    rclpy ends the whole process (exit code 102) when asked for one that is absent, so this must be known before.
    """
    name = environment.get("RMW_IMPLEMENTATION", "")
    installed = prefixes.resources("rmw_typesupport", prefixes.installed())
    return name if name and installed and name not in installed else None
