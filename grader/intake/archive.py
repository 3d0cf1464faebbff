"""A zip of a class's submissions, taken apart with no trust in it: names never become paths, and sizes are counted."""

from __future__ import annotations

import stat
import zipfile
import zlib
from collections.abc import Iterator
from datetime import datetime
from pathlib import Path, PurePosixPath

from grader.classroom import Skipped
from grader.intake.folder import WHY_NOISE, is_noise
from grader.intake.handed_in import SUFFIXES, File, IntakeError
from grader.submission.reading import MOST_BYTES

#: A thousand students with as many files as they like.
MOST_FILES = 20_000
MOST_BYTES_IN_ALL = 2_000_000_000

#: A little more than a submission may have: reading it says what is wrong with a larger one.
MOST_BYTES_OF_ONE = max(MOST_BYTES.values()) + 1

BROKEN = (zipfile.BadZipFile, zlib.error, EOFError, RuntimeError, NotImplementedError, OSError, ValueError)


def unpacked(archive: Path, into: Path) -> Iterator[File | Skipped]:
    """The files in `archive` that can be submissions, written into the folder `into` under numbers.

    Raises `IntakeError` when it is no zip, or holds more than any class hands in.
    """
    try:
        opened = zipfile.ZipFile(archive)
    except BROKEN as error:
        raise IntakeError(f"{archive}: it is no zip that can be read: {error}. Was the download cut off?") from None
    with opened:
        entries = [entry for entry in opened.infolist() if not entry.is_dir()]
        if len(entries) > MOST_FILES:
            raise IntakeError(f"{archive}: it holds {len(entries):,} files, more than {MOST_FILES:,}.")
        left = MOST_BYTES_IN_ALL
        for number, entry in enumerate(sorted(entries, key=lambda entry: entry.filename)):
            name = _name(entry)
            why = _why_not(entry, name)
            if why:
                yield Skipped(name, why)
                continue
            path = into / f"{number:05}{PurePosixPath(name).suffix}"
            try:
                with opened.open(entry) as packed:
                    content = packed.read(min(MOST_BYTES_OF_ONE, left + 1))
            except BROKEN as error:
                yield Skipped(name, f"it can't be read: {error}")
                continue
            left -= len(content)
            if left < 0:
                raise IntakeError(f"{archive}: unpacked, it is larger than {MOST_BYTES_IN_ALL // 10**9} GB.")
            path.write_bytes(content)
            yield File(name, path, _date(entry), "the zip file")


def _name(entry: zipfile.ZipInfo) -> str:
    parts = PurePosixPath(entry.filename.replace("\\", "/")).parts
    return "/".join(part for part in parts if part not in ("/", "..")) or "nameless"


def _why_not(entry: zipfile.ZipInfo, name: str) -> str:
    """Why an entry is left out, or nothing."""
    if any(is_noise(part) for part in name.split("/")):
        return WHY_NOISE
    if stat.S_ISLNK(entry.external_attr >> 16):
        return "a symbolic link, not a file"
    if entry.flag_bits & 1:
        return "it is encrypted"
    # nbgrader's time stamps are no submissions, but they tell when one was handed in.
    return "" if name.endswith((*SUFFIXES, "/timestamp.txt")) else f"not one of {', '.join(SUFFIXES)}"


def _date(entry: zipfile.ZipInfo) -> datetime | None:
    """A zip tells the local time of whoever made it, without a zone: taken as this machine's."""
    try:
        return datetime(*entry.date_time).astimezone()
    except (ValueError, OverflowError, OSError):
        return None
