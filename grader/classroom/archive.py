"""The files in a class's folder, zip or tar, without those that programs create there."""

from __future__ import annotations

import errno
import os
import stat
import tarfile
import zipfile
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from datetime import datetime, timezone
from functools import partial
from pathlib import Path, PurePosixPath
from typing import IO, NoReturn, cast

from grader.classroom.submissions import File, SubmissionsError
from grader.classroom.times import UNKNOWN, Time
from grader.grading.grade import SkippedFile
from grader.submission.archive import BROKEN, decompressed, is_tar, of_member, path_inside
from grader.submission.file_kinds import OTHER_ARCHIVES
from grader.submission.reader import MOST_BYTES

#: Created by operating systems, editors and Python, never by a student.
NOISE = {"__MACOSX", "__pycache__", "Thumbs.db", "desktop.ini"}
WHY_NOISE = "made by a program, not handed in"
ENCRYPTED = "it is encrypted. Unpack the zip file with its password, and give the folder."

#: A zip's earliest date, which programs write that leave out dates.
NO_DATE = (1980, 1, 1, 0, 0, 0)

#: The sources of dates that copying changes.
OF_FILES = ("the file's date", "the zip file", "the tar file")

#: Enough for a thousand students with 20 files each.
MOST_FILES = 20_000
MOST_BYTES_IN_ALL = 2_000_000_000

#: One byte more than a submission may have, so that the reader can say that it is too large.
MOST_BYTES_OF_ONE = max(MOST_BYTES.values()) + 1


def is_noise(name: str) -> bool:
    """Return whether a file or folder of this name can be ignored."""
    return name in NOISE or name.startswith((".", "~$")) or (name.startswith("#") and name.endswith("#"))


def walk(root: Path) -> Iterator[File | SkippedFile]:
    """Yield every file below `root`, sorted by name; symbolic links are not followed.

    Raises `SubmissionsError` for what may not be read: its student would be left out.
    """
    cloned: tuple[str, ...] = ()
    for folder, folders, names in os.walk(root, onerror=_refuse):
        inside = Path(folder).relative_to(root)
        cloned += (f"{folder}/",) if ".git" in (*folders, *names) else ()  # the files' dates are git's
        for name in sorted([*folders, *names]):
            if is_noise(name):
                yield SkippedFile((inside / name).as_posix(), WHY_NOISE)
        folders[:] = sorted(name for name in folders if not is_noise(name))
        if folder != str(root) and all(map(is_noise, [*folders, *names])):
            yield SkippedFile(inside.as_posix(), "a folder without a file")
        for name in sorted(names):
            if not is_noise(name):
                path = Path(folder, name)
                if path.is_file() and not os.access(path, os.R_OK, effective_ids=True):
                    _refuse(PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path)))
                yield File((inside / name).as_posix(), path, UNKNOWN if str(path).startswith(cloned) else date_of(path))


def _refuse(error: OSError) -> NoReturn:
    advice = "Allow yourself to read all submissions: chmod -R u+rX FOLDER"
    raise SubmissionsError(f"{error.filename}: it can't be read: {error.strerror}. {advice}")


def date_of(path: Path) -> Time:
    """Return the file's date, if any; an archive can give a file a date that does not exist."""
    try:
        return _time(path.lstat().st_mtime, OF_FILES[0])
    except OSError:
        return UNKNOWN


def _time(seconds: float, source: str) -> Time:
    if not seconds:  # what programs write that leave out dates
        return UNKNOWN
    try:
        return Time(datetime.fromtimestamp(seconds, timezone.utc), source)
    except (OSError, ValueError, OverflowError):
        return UNKNOWN


@dataclass(frozen=True)
class _Entry:
    """One entry of an archive.

    `load` returns its content, of a long one about as many bytes as its argument says. `is_link` is whether it is a
    symbolic link.
    """

    name: str
    load: Callable[[int], bytes | None]
    time: Time = UNKNOWN
    is_link: bool = False
    fault: str = ""


def unpacked(archive: Path, into: Path) -> Iterator[File | SkippedFile]:
    """Yield the files in `archive`, a zip or a tar, written into the folder `into` with numbers as names.

    Raises `SubmissionsError` if it can't be read, or holds more than any class submits.
    """
    names = Counter(entry.name for entry in _entries(archive))
    left = MOST_BYTES_IN_ALL
    for number, entry in enumerate(_entries(archive)):
        if any(is_noise(part) for part in entry.name.split("/")):
            yield SkippedFile(entry.name, WHY_NOISE)
            continue
        path = into / f"{number:05}{''.join(PurePosixPath(entry.name).suffixes)[-20:]}"
        if entry.is_link:
            path.symlink_to("nowhere")  # the reader reports it to the student
            yield File(entry.name, path)
            continue
        content, fault = _loaded(entry, left)
        if names[entry.name] > 1 and not fault:
            fault = "the archive holds several files of this name"
        if fault:
            yield File(entry.name, path, fault=fault)
            continue
        left -= len(content)
        if left < 0:
            raise SubmissionsError(_too_large(archive))
        path.write_bytes(content)
        yield File(entry.name, path, entry.time)


def _loaded(entry: _Entry, left: int) -> tuple[bytes, str]:
    """Return an entry's content, or why it can't be read."""
    if entry.fault:
        return b"", entry.fault
    try:
        return entry.load(min(MOST_BYTES_OF_ONE, left + 1)) or b"", ""
    except BROKEN as error:
        return b"", f"it can't be read: {error}. Was the download cut off?"


def _too_large(archive: Path) -> str:
    return f"{archive}: unpacked, it is larger than {MOST_BYTES_IN_ALL // 10**9} GB."


def _entries(archive: Path) -> Iterator[_Entry]:
    """Yield an archive's files and links, those of a zip sorted by name."""
    start = b""
    try:
        with archive.open("rb") as file:
            start = file.read(262)
        for count, entry in enumerate(_of_tar(archive, start) if is_tar(start) else _of_zip(archive)):
            if count == MOST_FILES:
                raise SubmissionsError(f"{archive}: it holds more than {MOST_FILES:,} files.")
            yield entry
    except BROKEN as error:
        advice = "Was the download cut off?"
        if start.startswith(OTHER_ARCHIVES):
            advice = "It is an archive of another kind: unpack it, and give the folder."
        kind = "tar" if is_tar(start) else "zip"
        raise SubmissionsError(
            f"{archive}: it is not a valid {kind} file: {error}. {advice} A class may also be a folder or a .csv file."
        ) from None


def _of_zip(archive: Path) -> Iterator[_Entry]:
    with zipfile.ZipFile(archive) as opened:
        for entry in sorted(opened.infolist(), key=_name):
            if not entry.is_dir():
                fault = ENCRYPTED if entry.flag_bits & 1 else ""
                is_link = stat.S_ISLNK(entry.external_attr >> 16)
                yield _Entry(_name(entry), partial(_of_zip_entry, opened, entry), _entry_date(entry), is_link, fault)


def _of_zip_entry(archive: zipfile.ZipFile, entry: zipfile.ZipInfo, most: int) -> bytes:
    with archive.open(entry) as packed:
        return packed.read(most)


def _of_tar(archive: Path, start: bytes) -> Iterator[_Entry]:
    """Yield a tar's entries in their order, as a compressed file can't be read backwards quickly."""
    with archive.open("rb") as file:
        bounded = _BoundedStream(archive, decompressed(file, start))
        with tarfile.open(fileobj=cast("IO[bytes]", bounded), mode="r|") as tar:
            for entry in _whole(tar, bounded):
                if entry.isdir():
                    continue
                is_file = entry.isfile()
                fault = "" if is_file or entry.issym() else "it is a hard link or a device in the archive, not a file"
                time = _time(entry.mtime, OF_FILES[2]) if is_file else UNKNOWN
                yield _Entry(
                    path_inside(entry.name) or "nameless", partial(of_member, tar, entry), time, entry.issym(), fault
                )


def _whole(tar: tarfile.TarFile, stream: _BoundedStream) -> Iterator[tarfile.TarInfo]:
    """Yield the entries. Raises EOFError if the zeros at the end are missing, which `tarfile` does not say."""
    yield from tar
    if stream.last.strip(b"\0"):
        raise EOFError("it ends in the middle")


class _BoundedStream:
    """A stream of a class's tar that ends with an error after more bytes than any class has. `last` ends it so far."""

    def __init__(self, archive: Path, stream: IO[bytes]) -> None:
        self.archive, self.stream, self.left, self.last = archive, stream, MOST_BYTES_IN_ALL, b""

    def read(self, most: int) -> bytes:
        """Return the next bytes. Raises `SubmissionsError` beyond the limit."""
        data = self.stream.read(most)
        self.left -= len(data)
        self.last = data[-512:] or self.last
        if self.left < 0:
            raise SubmissionsError(_too_large(self.archive))
        return data


def _name(entry: zipfile.ZipInfo) -> str:
    return path_inside(_decoded(entry)) or "nameless"


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
        return UNKNOWN if entry.date_time <= NO_DATE else Time(datetime(*entry.date_time).astimezone(), OF_FILES[1])
    except (ValueError, OverflowError, OSError):
        return Time()
