"""Writes files whole or not at all, and only when their content changes."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

#: How the name of a file ends while it is being written.
PART = ".part"


def cached(kind: str) -> Path:
    """The folder for one kind of what can be made again: in `SPINBOOK_CACHE`, else in the user's cache folder."""
    if given := os.environ.get("SPINBOOK_CACHE"):
        return Path(given) / kind
    base = os.environ.get("XDG_CACHE_HOME") or Path("~/.cache").expanduser()
    return Path(base) / "spinbook" / kind


def write_if_changed(file: Path, content: str | bytes, *, durable: bool = False) -> bool:
    """Make `file` hold `content`, and its folders exist. True if it had to be written.

    Whoever reads the file meanwhile sees the old content or the new, never a part. A `durable` file survives a loss of
    power, too: it is on the disk before it takes the old one's place.
    """
    data = content.encode("utf-8", errors="backslashreplace") if isinstance(content, str) else content
    if _holds(file, data):
        return False
    file.parent.mkdir(parents=True, exist_ok=True)
    descriptor, temporary = tempfile.mkstemp(dir=file.parent, prefix=f".{file.name}.", suffix=PART)
    try:
        with os.fdopen(descriptor, "wb") as out:
            out.write(data)
            if durable:
                out.flush()
                os.fsync(out.fileno())
        os.chmod(temporary, 0o644)  # noqa: PTH101
        os.replace(temporary, file)  # noqa: PTH105
    except BaseException:
        os.unlink(temporary)  # noqa: PTH108
        raise
    return True


def remove_parts(folder: Path) -> None:
    """Remove what a process that was killed left half-written in `folder`. Nobody may write there meanwhile."""
    for part in folder.glob(f".*.????????{PART}"):
        part.unlink(missing_ok=True)


def _holds(file: Path, data: bytes) -> bool:
    try:
        return file.read_bytes() == data
    except OSError:
        return False
