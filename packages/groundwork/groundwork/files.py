"""Writes files whole or not at all, and only when their content changes; claims a file for one process."""

from __future__ import annotations

import contextlib
import fcntl
import json
import os
import tempfile
import zlib
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, TypeVar

# To read the umask is to change it for a moment, in which no other thread may create a file: so it is read once.
_UMASK = os.umask(0o077)
os.umask(_UMASK)

#: How the name of a file ends while it is being written.
PART = ".part"


def cached(kind: str) -> Path:
    """The folder for one kind of what can be made again: in `SPINBOOK_CACHE`, else in the user's cache folder."""
    if folder := os.environ.get("SPINBOOK_CACHE"):
        return Path(folder) / kind
    # A user whom no list of users names, and without HOME, has no home folder: / is HOME in containers.
    home = os.path.expanduser("~").replace("~", "/", 1)  # noqa: PTH111 (Path.home raises where there is none)
    base = os.environ.get("XDG_CACHE_HOME") or Path(home, ".cache")
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
        os.chmod(temporary, 0o666 & ~_UMASK)  # noqa: PTH101
        os.replace(temporary, file)  # noqa: PTH105
    except BaseException:
        os.unlink(temporary)  # noqa: PTH108
        raise
    return True


def write_folder(folder: Path, files: Mapping[str, str | bytes]) -> None:
    """Make `folder` hold these files, by their paths in it, and no others. Unchanged files are not written."""
    for entry in sorted(folder.rglob("*"), reverse=True):
        if entry.is_file() and entry.relative_to(folder).as_posix() not in files:
            entry.unlink()
        elif entry.is_dir() and not any(entry.iterdir()):
            entry.rmdir()
    for path, content in files.items():
        write_if_changed(folder / path, content)


Kept = TypeVar("Kept")


def read_kept(file: Path, decoded: Callable[[bytes], Kept]) -> Kept | None:
    """Return what is kept in a file, `decoded`; None if it is missing or damaged, and so has to be made again."""
    try:
        return decoded(file.read_bytes())
    except (OSError, EOFError, zlib.error, ValueError, KeyError, TypeError, AttributeError):
        return None


def keep(file: Path, content: str | bytes, *, durable: bool = False) -> None:
    """Write a file whole, for `read_kept`. If it can't be written, its content is made again each time."""
    with contextlib.suppress(OSError):
        write_if_changed(file, content, durable=durable)


def json_object(file: Path) -> dict[str, Any]:
    """Return the JSON object in a file; {} if there is no such file, or no object in it."""
    try:
        content = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return content if isinstance(content, dict) else {}


def from_here(path: Path) -> Path:
    """Return a path as seen from the current folder, if it is below that."""
    return path.relative_to(Path.cwd()) if path.is_relative_to(Path.cwd()) else path


def remove_parts(folder: Path) -> None:
    """Remove what a process that was killed left half-written in `folder`. Nobody may write there meanwhile."""
    for part in folder.glob(f".*.????????{PART}"):
        part.unlink(missing_ok=True)


def _holds(file: Path, data: bytes) -> bool:
    try:
        return file.read_bytes() == data
    except OSError:
        return False


def try_lock(file: Path) -> int | None:
    """The descriptor that holds the lock on `file`, until it is closed; None where another process holds it.

    The file is made if it is missing. Raises OSError where it can't be opened.
    """
    descriptor = _open(file)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        os.close(descriptor)
        return None
    return descriptor


def claim_number(folder: Path, numbers: Iterable[int]) -> tuple[int, int] | None:
    """The first of `numbers` that nobody holds in `folder`, and the descriptor that holds it; None where all are taken.

    Numbers whose files can't be opened are left out.
    """
    for number in numbers:
        try:
            lock = try_lock(folder / str(number))
        except OSError:
            continue
        if lock is not None:
            return number, lock
    return None


def _open(file: Path) -> int:
    flags = os.O_RDONLY | os.O_CLOEXEC | os.O_NOFOLLOW
    try:
        return os.open(file, flags | os.O_CREAT, 0o644)
    except PermissionError:
        # In folders that all users share, the kernel forbids O_CREAT on others' files (fs.protected_regular).
        return os.open(file, flags)
