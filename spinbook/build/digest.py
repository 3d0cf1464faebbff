"""Digests that say whether something must be made again."""

from __future__ import annotations

import functools
import hashlib
import importlib.metadata
import os
import platform
from collections.abc import Iterable
from pathlib import Path

import spinbook


def digest(*parts: str | bytes) -> str:
    """A digest of these parts, in this order, that depends on where each part ends."""
    total = hashlib.sha256()
    for part in parts:
        data = part.encode() if isinstance(part, str) else part
        total.update(len(data).to_bytes(8, "big"))
        total.update(data)
    return total.hexdigest()


def files_digest(files: Iterable[Path], root: Path) -> str:
    """A digest of files' names below `root` and of their contents; a missing file counts as missing. It does not depend
    on where `root` is, so that a course that has been moved need not be made again.
    """
    return digest(*(part for file in sorted(files) for part in (os.path.relpath(file, root), _bytes(file))))


def _bytes(file: Path) -> bytes:
    try:
        return file.read_bytes()
    except OSError:
        return b"\0missing"


def folders_digest(root: Path, *parts: str) -> str:
    """A digest of these files of `root` and of all files in these folders, without those that Python compiled."""
    return files_digest((file for part in parts for file in _files(root / part) if file.suffix != ".pyc"), root)


def _files(path: Path) -> Iterable[Path]:
    return [path] if path.is_file() else path.rglob("*.*")


@functools.cache
def code_digest(*folders: str) -> str:
    """A digest of Spinbook's own code in these folders: what it makes may change with it."""
    return folders_digest(Path(spinbook.__file__).parent, *folders)


@functools.cache
def versions() -> str:
    """The versions on which a notebook's outputs depend."""
    names = ("ros-rclpy", "matplotlib", "ipykernel", "nbclient")
    found = [f"{name}={_version(name)}" for name in names]
    return " ".join([f"python={platform.python_version()}", *found])


def _version(distribution: str) -> str:
    try:
        return importlib.metadata.version(distribution)
    except importlib.metadata.PackageNotFoundError:
        return "none"
