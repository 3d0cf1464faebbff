"""Writes files whole or not at all, and only when their content changes."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path


def write_durably(file: Path, content: str) -> None:
    """Make `file` hold `content`, unless it does already. Whoever reads meanwhile sees the old or the new."""
    write_bytes(file, content.encode("utf-8", errors="backslashreplace"))


def write_bytes(file: Path, data: bytes) -> None:
    """Make `file` hold `data`, unless it does already. Whoever reads meanwhile sees the old or the new."""
    try:
        if file.read_bytes() == data:
            return
    except OSError:
        pass
    file.parent.mkdir(parents=True, exist_ok=True)
    handle, temporary = tempfile.mkstemp(dir=file.parent, prefix=f".{file.name}.")
    try:
        with os.fdopen(handle, "wb") as out:
            out.write(data)
            out.flush()
            os.fsync(out.fileno())  # else a loss of power could leave the new name with nothing in it
        os.chmod(temporary, 0o644)  # noqa: PTH101
        os.replace(temporary, file)  # noqa: PTH105
    except BaseException:
        os.unlink(temporary)  # noqa: PTH108
        raise


def write_if_changed(file: Path, content: str | bytes) -> bool:
    """Make `file` hold `content`, and its folders exist. True if it had to be written.

    Whoever reads the file meanwhile sees the old content or the new, never a part.
    """
    data = content.encode("utf-8") if isinstance(content, str) else content
    try:
        if file.read_bytes() == data:
            return False
    except OSError:
        pass
    file.parent.mkdir(parents=True, exist_ok=True)
    handle, temporary = tempfile.mkstemp(dir=file.parent, prefix=f".{file.name}.")
    try:
        with os.fdopen(handle, "wb") as out:
            out.write(data)
        os.chmod(temporary, 0o644)  # noqa: PTH101
        os.replace(temporary, file)  # noqa: PTH105
    except BaseException:
        os.unlink(temporary)  # noqa: PTH108
        raise
    return True
