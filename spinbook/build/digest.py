"""Digests that say whether something must be made again."""

from __future__ import annotations

import functools
import hashlib
import os
import platform
from collections.abc import Iterable
from pathlib import Path

import ros_in_python
import spinbook
from groundwork.installed import version_of


def digest(*parts: str | bytes) -> str:
    """Return a digest of these parts, in this order, that depends on where each part ends."""
    total = hashlib.sha256()
    for part in parts:
        data = part.encode() if isinstance(part, str) else part
        total.update(len(data).to_bytes(8, "big"))
        total.update(data)
    return total.hexdigest()


def files_digest(files: Iterable[Path], root: Path) -> str:
    """Return a digest of the names and contents of files below `root`; a missing file changes it, too. It does not
    depend on where `root` is, so a course that was moved need not be built again.
    """
    return digest(*(part for file in sorted(files) for part in (os.path.relpath(file, root), _bytes(file))))


def _bytes(file: Path) -> bytes:
    try:
        return file.read_bytes()
    except OSError:
        return b"\0missing"


def folders_digest(root: Path, *parts: str) -> str:
    """Return a digest of these files of `root` and all files in these folders, without Python's compiled ones."""
    paths = [root / part for part in parts]
    files = (file for path in paths for file in ([path] if path.is_file() else path.rglob("*.*")))
    return files_digest((file for file in files if file.suffix != ".pyc"), root)


@functools.cache
def code_digest(*folders: str) -> str:
    """Return a digest of Spinbook's own code in these folders, and of ros_in_python: its output may change with it."""
    root = Path(spinbook.__file__).parent
    assert all((root / folder).exists() for folder in folders), folders
    return digest(folders_digest(root, *folders), folders_digest(Path(ros_in_python.__file__).parent, "."))


@functools.cache
def versions() -> str:
    """Return the versions on which a notebook's outputs depend."""
    names = ("ros-rclpy", "matplotlib", "ipykernel", "nbclient")
    packages = [f"{name}={version_of(name, otherwise='none')}" for name in names]
    return " ".join([f"python={platform.python_version()}", *packages])
