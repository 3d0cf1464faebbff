"""Prefixes as a ROS installation has them, and what sourcing them would set."""

from __future__ import annotations

import os
from importlib.machinery import EXTENSION_SUFFIXES
from pathlib import Path


def empty_rclpy(prefix: Path, suffix: str = EXTENSION_SUFFIXES[0], distro: str = "jazzy") -> dict[str, str]:
    """Make a prefix whose rclpy has the files that show for which Python it was built, and nothing in them."""
    packages = prefix / "lib" / "python3" / "site-packages"
    (packages / "rclpy").mkdir(parents=True)
    (packages / "rclpy" / "__init__.py").touch()
    (packages / "rclpy" / f"_rclpy_pybind11{suffix}").touch()
    return sourcing(prefix, packages, distro)


def ros_1(prefix: Path) -> dict[str, str]:
    """Make a prefix with ROS 1's messages and no rclpy."""
    packages = prefix / "lib" / "python3" / "dist-packages"
    (packages / "std_msgs").mkdir(parents=True)
    (packages / "std_msgs" / "__init__.py").touch()
    return sourcing(prefix, packages, "noetic")


def sourcing(prefix: Path, packages: Path, distro: str) -> dict[str, str]:
    """Return the variables that sourcing a prefix's setup file sets."""
    return {
        "ROS_DISTRO": distro,
        "AMENT_PREFIX_PATH": os.fspath(prefix),
        "PYTHONPATH": os.fspath(packages),
        "LD_LIBRARY_PATH": os.fspath(prefix / "lib"),
    }
