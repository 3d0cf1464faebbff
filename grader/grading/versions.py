"""What a grade depends on beside the submission."""

from __future__ import annotations

import hashlib
import platform
from functools import cache
from importlib import metadata
from pathlib import Path

from grader.sandbox import Middleware
from rmw_lockstep.library import sources

GRADER = Path(__file__).parents[1]


@cache
def versions(middleware: Middleware) -> dict[str, str]:
    """The middleware, versions of Python, ROS and the middleware, and a digest of the grader's own source."""
    return {
        "python": platform.python_version(),
        "rclpy": _version("ros-jazzy-rclpy", "rclpy"),
        "middleware": str(middleware),
        "rmw": _lockstep() if middleware is Middleware.LOCKSTEP else _fast_dds(),
        "grader": digest_of(sorted(GRADER.rglob("*.py")))[:12],
    }


def digest_of(files: list[Path]) -> str:
    """SHA-256 of these files' contents, in this order."""
    total = hashlib.sha256()
    for file in files:
        content = file.read_bytes()
        total.update(f"{file.name} {len(content)}\n".encode())
        total.update(content)
    return total.hexdigest()


def _lockstep() -> str:
    """A digest of the middleware, its end in C++ and its hub in Python."""
    folder = GRADER.with_name("rmw_lockstep")
    return digest_of([*sources(), *sorted(folder.rglob("*.py"))])[:12]


def _fast_dds() -> str:
    return _version("ros-rmw-fastrtps-cpp", "rmw_fastrtps_cpp")


def _version(*names: str) -> str:
    for name in names:
        try:
            return metadata.version(name)
        except metadata.PackageNotFoundError:
            continue
    return "unknown"
