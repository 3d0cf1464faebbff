"""What a grade depends on beside the submission."""

from __future__ import annotations

import hashlib
import platform
from functools import cache
from importlib import metadata
from pathlib import Path

GRADER = Path(__file__).parents[1]


@cache
def versions() -> dict[str, str]:
    """Versions of Python and ROS, and a digest of the grader's own source."""
    return {
        "python": platform.python_version(),
        "rclpy": _version("ros-jazzy-rclpy", "rclpy"),
        "rmw": _version("ros-rmw-fastrtps-cpp", "rmw_fastrtps_cpp"),
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


def _version(*names: str) -> str:
    for name in names:
        try:
            return metadata.version(name)
        except metadata.PackageNotFoundError:
            continue
    return "unknown"
