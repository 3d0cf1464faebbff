"""The environment of a notebook's processes: a ROS domain of their own, this machine only, readable logs."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from groundwork.files import claim_number
from interface_compiler import prefixes
from ros_in_python.ros2.executables import add_own_prefix

LOOPBACK_PROFILE = Path(__file__).with_name("loopback.xml")
#: No time stamps, so that the log is the same in every build.
LOG_FORMAT = "[{severity}] [{name}]: {message}"
#: Set while `spinbook build` runs a notebook: nobody is watching, so plots are drawn only once.
EXECUTING = "SPINBOOK_EXECUTING"
#: The file into which a notebook writes its ROS domain, for an observer.
DOMAIN_NOTE = "SPINBOOK_DOMAIN_NOTE"
#: What would let nodes look for others elsewhere than in their domain on this machine, or keep them from starting.
OF_OTHER_NETWORKS = (
    *(
        "ROS_DISCOVERY_SERVER",
        "ROS_STATIC_PEERS",
        "ROS_LOCALHOST_ONLY",
        "ROS_SUPER_CLIENT",
        "FASTDDS_BUILTIN_TRANSPORTS",
    ),
    *("ROS_SECURITY_ENABLE", "ROS_SECURITY_STRATEGY", "RCL_ASSERT_RMW_ID_MATCHES", "CYCLONEDDS_URI"),
)


def for_domain(domain: int, environment: Mapping[str, str]) -> dict[str, str]:
    """Return the variables with which ROS processes communicate in `domain`, on this machine only. Fast DDS (the
    default) gets a profile for UDP on 127.0.0.1; other middlewares get LOCALHOST.
    """
    is_fast_dds = environment.get("RMW_IMPLEMENTATION", "rmw_fastrtps_cpp").startswith("rmw_fastrtps")
    settings = {
        "ROS_DOMAIN_ID": str(domain),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "SYSTEM_DEFAULT" if is_fast_dds else "LOCALHOST",
        "RCUTILS_CONSOLE_OUTPUT_FORMAT": environment.get("RCUTILS_CONSOLE_OUTPUT_FORMAT", LOG_FORMAT),
        "RCUTILS_COLORIZED_OUTPUT": environment.get("RCUTILS_COLORIZED_OUTPUT", "0"),
        # Jupyter asks every program for colours; Python obeys since 3.13.
        "PYTHON_COLORS": environment.get("PYTHON_COLORS", "0"),
        "PYTHONUNBUFFERED": "1",
    }
    searched = dict(environment)
    add_own_prefix(searched)
    if "AMENT_PREFIX_PATH" in searched:
        settings["AMENT_PREFIX_PATH"] = searched["AMENT_PREFIX_PATH"]
    if is_fast_dds:
        settings["FASTRTPS_DEFAULT_PROFILES_FILE"] = os.fspath(LOOPBACK_PROFILE)
        settings["FASTDDS_DEFAULT_PROFILES_FILE"] = os.fspath(LOOPBACK_PROFILE)
    if "HOME" not in environment:
        # rclpy.init raises without one, even if ROS_LOG_DIR is set.
        settings["HOME"] = tempfile.gettempdir()
    if not _can_write_logs(environment):
        # It also raises if it can't write its log files.
        settings["ROS_LOG_DIR"] = os.fspath(Path(tempfile.gettempdir()) / f"spinbook-ros-log-{os.getuid()}")
    return settings


def _can_write_logs(environment: Mapping[str, str]) -> bool:
    """Make the folder of ROS's logs, as rclpy.init does; return whether that is possible."""
    home = environment.get("ROS_HOME") or Path(environment.get("HOME", "/nowhere"), ".ros")
    folder = Path(environment.get("ROS_LOG_DIR") or Path(home, "log")).expanduser()
    with contextlib.suppress(OSError):
        folder.mkdir(parents=True, exist_ok=True)
    return os.access(folder, os.W_OK)


def missing_middleware(environment: Mapping[str, str]) -> str | None:
    """Return the middleware that RMW_IMPLEMENTATION names, if it is not installed here.

    rclpy ends the whole process (exit code 102) if it is missing, so this must be known in advance.
    """
    name = environment.get("RMW_IMPLEMENTATION", "")
    installed = prefixes.resources("rmw_typesupport", prefixes.installed())
    return name if name and installed and name not in installed else None


# A domain is held by a lock on a file that every user of the machine can open; the lock ends with the kernel,
# however it ends. Domains up to 101 have ports below Linux's ephemeral range (ROS 2's concepts, "The ROS_DOMAIN_ID").


#: 0 is every program's default, so it is left to the terminals of this machine.
OWN_DOMAINS = range(1, 60)
HIGHEST = 101


@dataclass(frozen=True)
class Domain:
    """A ROS domain. `lock` is the open file that holds it, or None if it is shared with others on purpose."""

    number: int
    lock: int | None

    def release(self) -> None:
        """Release the domain."""
        if self.lock is not None:
            os.close(self.lock)


class NoDomainLeft(Exception):
    """Every domain is in use by a running notebook."""


def claim_domain() -> Domain:
    """Take a domain that is free on this machine. Raises NoDomainLeft."""
    folder = Path(tempfile.gettempdir()) / "spinbook-domains"
    folder.mkdir(exist_ok=True)
    with contextlib.suppress(PermissionError):
        folder.chmod(0o1777)
    # Each process begins elsewhere, so that notebooks that start together do not all compete for the first domain.
    start = os.getpid() % len(OWN_DOMAINS)
    claimed = claim_number(folder, [*OWN_DOMAINS[start:], *OWN_DOMAINS[:start]])
    if claimed is None:
        raise NoDomainLeft(
            f"all {len(OWN_DOMAINS)} ROS domains are in use by notebooks on this machine: close some of them."
        )
    return Domain(*claimed)


def shared_domain(number: int) -> Domain:
    """Return a domain that others may use too. Raises ValueError if it is not a ROS domain."""
    if not 0 <= number <= HIGHEST:
        raise ValueError(f"a ROS domain is a number from 0 to {HIGHEST}, not {number}.")
    return Domain(number, None)
