"""Identical files in an environment, as hard links: wheels have no links, so pip writes copies."""

from __future__ import annotations

import hashlib
import os
from itertools import groupby
from pathlib import Path

#: A smaller file (bytes) is not worth its while.
_SMALLEST = 20_000


def link_copies(environment: Path) -> int:
    """Make copies of the same file one file with several names. Return how many bytes that has saved.

    pip replaces and removes names, so it can go on updating the environment. Raises OSError if the folder can't be
    written, or if its file system has no hard links.
    """
    files = [(_content(file), file) for file in sorted(environment.rglob("*")) if _counts(file)]
    saved = 0
    for _, copies in groupby(sorted(files), key=lambda file: file[0]):
        first, *others = (file for _, file in copies)
        saved += sum(_replaced(copy, first) for copy in others if not copy.samefile(first))
    return saved


def _counts(file: Path) -> bool:
    return file.is_file() and not file.is_symlink() and file.stat().st_size >= _SMALLEST


def _content(file: Path) -> bytes:
    return hashlib.sha256(file.read_bytes()).digest()


def _replaced(copy: Path, first: Path) -> int:
    """Put a second name of `first` in the place of a copy, which at no moment is missing; return the copy's size."""
    size = copy.stat().st_size if copy.stat().st_nlink == 1 else 0
    name = copy.with_name(f".{copy.name}.{os.getpid()}")
    os.link(first, name)
    name.replace(copy)
    return size
