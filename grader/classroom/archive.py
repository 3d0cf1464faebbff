"""The files in a class's folder or zip, without those that programs create there."""

from __future__ import annotations

import os
import stat
import zipfile
import zlib
from collections import Counter
from collections.abc import Iterator
from datetime import datetime, timezone
from pathlib import Path, PurePosixPath

from grader.classroom.submissions import File, SubmissionsError
from grader.classroom.times import Time
from grader.grading.grade import Skipped
from grader.submission.reader import MOST_BYTES

#: Created by operating systems, editors and Python, never by a student.
NOISE = {"__MACOSX", "__pycache__", "Thumbs.db", "desktop.ini"}
WHY_NOISE = "made by a program, not handed in"

#: Enough for a thousand students with 20 files each.
MOST_FILES = 20_000
MOST_BYTES_IN_ALL = 2_000_000_000

#: One byte more than a submission may have, so that the reader can say that it is too large.
MOST_BYTES_OF_ONE = max(MOST_BYTES.values()) + 1

BROKEN = (zipfile.BadZipFile, zlib.error, EOFError, RuntimeError, NotImplementedError, OSError, ValueError)


def is_noise(name: str) -> bool:
    """Return whether a file or folder of this name can be ignored."""
    return name in NOISE or name.startswith(".")


def walk(root: Path) -> Iterator[File | Skipped]:
    """Yield every file below `root`, sorted by name; symbolic links are not followed."""
    for folder, folders, names in os.walk(root):
        inside = Path(folder).relative_to(root)
        for name in sorted([*folders, *names]):
            if is_noise(name):
                yield Skipped((inside / name).as_posix(), WHY_NOISE)
        folders[:] = sorted(name for name in folders if not is_noise(name))
        for name in sorted(names):
            if not is_noise(name):
                path = Path(folder, name)
                yield File((inside / name).as_posix(), path, date_of(path))


def date_of(path: Path) -> Time:
    """Return the file's date, if any; an archive can give a file a date that does not exist."""
    try:
        return Time(datetime.fromtimestamp(path.lstat().st_mtime, timezone.utc), "the file's date")
    except (OSError, ValueError, OverflowError):
        return Time()


def unpacked(archive: Path, into: Path) -> Iterator[File | Skipped]:
    """Yield the files in `archive`, written into the folder `into` with numbers as names.

    Raises `SubmissionsError` if it is not a zip, or holds more than any class submits.
    """
    try:
        opened = zipfile.ZipFile(archive)
    except BROKEN as error:
        raise SubmissionsError(
            f"{archive}: it is not a valid zip file: {error}. Was the download cut off? A class may also be a "
            "folder or a .csv file."
        ) from None
    with opened:
        entries = [entry for entry in opened.infolist() if not entry.is_dir()]
        if len(entries) > MOST_FILES:
            raise SubmissionsError(f"{archive}: it holds {len(entries):,} files, more than {MOST_FILES:,}.")
        left, names = MOST_BYTES_IN_ALL, Counter(map(_name, entries))
        for number, entry in enumerate(sorted(entries, key=_name)):
            name = _name(entry)
            if any(is_noise(part) for part in name.split("/")):
                yield Skipped(name, WHY_NOISE)
                continue
            path = into / f"{number:05}{''.join(PurePosixPath(name).suffixes)[-20:]}"
            if stat.S_ISLNK(entry.external_attr >> 16):
                path.symlink_to("nowhere")  # the reader reports it to the student
                yield File(name, path)
                continue
            try:
                with opened.open(entry) as packed:
                    content = packed.read(min(MOST_BYTES_OF_ONE, left + 1))
            except BROKEN as error:
                fault = "it is encrypted" if entry.flag_bits & 1 else f"it can't be read: {error}"
                yield File(name, path, fault=f"{fault}. Was the download cut off?")
                continue
            if names[name] > 1:
                yield File(name, path, fault="the zip holds several files of this name")
                continue
            left -= len(content)
            if left < 0:
                raise SubmissionsError(f"{archive}: unpacked, it is larger than {MOST_BYTES_IN_ALL // 10**9} GB.")
            path.write_bytes(content)
            yield File(name, path, _entry_date(entry))


def _name(entry: zipfile.ZipInfo) -> str:
    parts = PurePosixPath(_decoded(entry).replace("\\", "/")).parts
    return "/".join(part for part in parts if part not in ("/", "..")) or "nameless"


def _decoded(entry: zipfile.ZipInfo) -> str:
    """Return the name; macOS writes UTF-8 without the flag that says so (APPNOTE.TXT, appendix D)."""
    if entry.flag_bits & 0x800:
        return entry.filename
    try:
        return entry.filename.encode("cp437").decode("utf-8")
    except UnicodeError:
        return entry.filename


def _entry_date(entry: zipfile.ZipInfo) -> Time:
    """Return an entry's date. A zip has the local time of its creator, without a zone: taken as this machine's."""
    try:
        return Time(datetime(*entry.date_time).astimezone(), "the zip file")
    except (ValueError, OverflowError, OSError):
        return Time()
