"""What compiling needs from the machine: gcc, g++ and Python's headers."""

from __future__ import annotations

import os
import shutil
import sys
import sysconfig
from pathlib import Path


def missing_compiler() -> str | None:
    """Return one sentence with the package to install, if gcc or g++ is missing."""
    absent = [program for program in ("gcc", "g++") if shutil.which(program) is None]
    if not absent:
        return None
    return f"Interfaces are compiled with {' and '.join(absent)}, not found here: {_install('g++', 'gcc-c++')}"


def missing_headers() -> str | None:
    """Return one sentence with the package to install, if Python.h is missing."""
    if (headers() / "Python.h").is_file():
        return None
    if sys.base_prefix != "/usr":
        return (
            f"Interfaces are compiled with Python.h, not found in {headers()}: install a Python that has its headers."
        )
    return f"Interfaces are compiled with Python.h, not found here: {_install(_python_dev(), 'python3-devel')}"


def missing() -> str | None:
    """Return what is missing, with the packages to install; None if interfaces can be compiled."""
    if ros := sourced_ros():
        return (
            f"ROS 2 is sourced from {ros}, whose own tools compile interfaces: "
            "run `colcon build` in the workspace, source its install/setup.bash, and start this again there."
        )
    return "; ".join(filter(None, (missing_compiler(), missing_headers()))) or None


def debian_packages() -> list[str]:
    """Return the names of the missing packages in Debian and Ubuntu."""
    packages = ["g++"] if missing_compiler() else []
    return packages + ([_python_dev()] if missing_headers() and sys.base_prefix == "/usr" else [])


def headers() -> Path:
    """Return the folder that has Python.h if it is installed."""
    return Path(sysconfig.get_path("include"))


def sourced_ros() -> Path | None:
    """Return the prefix of a sourced ROS 2, which has its own tools for interfaces; None if ROS 2 came from PyPI."""
    if (Path(sys.prefix) / "share" / "rosidl_adapter").is_dir():
        return None
    for entry in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep):
        if entry and (Path(entry) / "share" / "rosidl_adapter").is_dir():
            return Path(entry)
    return None


def _python_dev() -> str:
    return f"python{sys.version_info.major}.{sys.version_info.minor}-dev"


def _install(debian: str, fedora: str) -> str:
    if shutil.which("apt-get"):
        return f"sudo apt-get install {debian}"
    if shutil.which("dnf"):
        return f"sudo dnf install {fedora}"
    return f"install {debian}, as it is called on Debian and Ubuntu."
