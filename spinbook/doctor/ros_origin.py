"""Decides where ROS 2 comes from: a sourced installation, or the wheels from PyPI, but never both.

This is also a program, with only the standard library, that `make setup` runs before anything is installed: it prints
`wheels` or `sourced FOLDER`. If neither works, it says why on stderr and exits with 1.
"""

from __future__ import annotations

import os
import platform
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.machinery import EXTENSION_SUFFIXES
from pathlib import Path

#: ROS 2 releases before Jazzy: no ROS_AUTOMATIC_DISCOVERY_RANGE (before Iron), or no longer maintained.
TOO_OLD = ("ardent", "bouncy", "crystal", "dashing", "eloquent", "foxy", "galactic", "humble", "iron")
#: What the wheels are tagged for: manylinux_2_28_x86_64.
WHEELS_GLIBC = (2, 28)


@dataclass(frozen=True)
class Machine:
    """The properties that binary packages depend on: the system, the processor, the C library, the Python."""

    system: str
    processor: str
    libc: str
    python: tuple[int, int]
    suffixes: Sequence[str]


@dataclass(frozen=True)
class RosOrigin:
    """`sourced` is the folder on PYTHONPATH that holds rclpy, or None if the wheels are to be used."""

    sourced: Path | None

    def __str__(self) -> str:
        return f"sourced {self.sourced}" if self.sourced else "wheels"


class NoRos(Exception):
    """Raised if neither a sourced ROS 2 nor the wheels can be used here."""


def this_machine() -> Machine:
    """Return the properties of this machine and this Python."""
    libc = " ".join(platform.libc_ver()) if sys.platform == "linux" else ""
    return Machine(platform.system(), platform.machine(), libc, sys.version_info[:2], EXTENSION_SUFFIXES)


def ros_origin(environment: Mapping[str, str], machine: Machine) -> RosOrigin:
    """Return which ROS 2 to use. Looks at files only; imports nothing.

    Raises NoRos, with what to do, if a sourced ROS does not fit, or if there is none and the wheels don't fit.
    """
    entries = [Path(entry) for entry in environment.get("PYTHONPATH", "").split(os.pathsep) if entry]
    sourced = next((entry for entry in entries if (entry / "rclpy" / "__init__.py").is_file()), None)
    if sourced:
        _refuse_misfit(sourced, environment.get("ROS_DISTRO", ""), machine)
        return RosOrigin(sourced)
    foreign = next((entry for entry in entries if (entry / "std_msgs" / "__init__.py").is_file()), None)
    if foreign:
        raise NoRos(
            f"PYTHONPATH names {foreign}, which has a ROS without rclpy (ROS 1?). Its message packages would hide "
            f"those of ROS 2.\n{_IN_A_CLEAN_TERMINAL}"
        )
    _refuse_without_wheels(machine)
    return RosOrigin(None)


_IN_A_CLEAN_TERMINAL = (
    "Run it again in a terminal in which no ROS setup file is sourced (look for one in ~/.bashrc). ROS 2 Jazzy then "
    "comes from PyPI."
)


def _refuse_misfit(sourced: Path, distro: str, machine: Machine) -> None:
    if distro in TOO_OLD:
        raise NoRos(
            f"The sourced ROS 2 is {distro.capitalize()} ({sourced}), and Spinbook needs Jazzy or newer.\n"
            + _IN_A_CLEAN_TERMINAL
        )
    extensions = list((sourced / "rclpy").glob("_rclpy_pybind11*"))
    if not any((sourced / "rclpy" / f"_rclpy_pybind11{suffix}").is_file() for suffix in machine.suffixes):
        here = "{}.{}".format(*machine.python)
        built = ", ".join(sorted(file.name for file in extensions)) or "no compiled module at all"
        raise NoRos(
            f"The sourced ROS 2 ({sourced}) is not for Python {here}: it has {built}.\n"
            "Use the Python that it was built for (for Jazzy on Ubuntu 24.04: make PYTHON=python3.12 ...), or a "
            "terminal in which no ROS setup file is sourced."
        )


def _refuse_without_wheels(machine: Machine) -> None:
    reason = None
    if (machine.system, machine.processor) != ("Linux", "x86_64"):
        reason = f"this is {machine.system} on {machine.processor}"
    elif not machine.libc.startswith("glibc"):
        reason = f"this Linux has another C library ({machine.libc.strip() or 'not glibc'})"
    elif tuple(int(part) for part in machine.libc.split()[1].split(".")[:2]) < WHEELS_GLIBC:
        reason = f"this Linux has {machine.libc}"
    if reason:
        raise NoRos(
            f"PyPI has ROS 2 for Linux on x86_64 with glibc 2.28 or newer only, and {reason}.\n"
            "Install ROS 2 Jazzy, source it, and run this again; or use a container. See docs/installing.md."
        )


if __name__ == "__main__":
    try:
        print(ros_origin(os.environ, this_machine()))
    except NoRos as error:
        sys.exit(str(error))
