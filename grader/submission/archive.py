"""Reads a folder or an archive as students pack it, without the files that tools create.

Nothing is written to disk, no path leads outside, and the sizes that an archive states are not trusted: reading ends
when the limits are reached.
"""

from __future__ import annotations

import bz2
import contextlib
import errno
import gzip
import io
import os
import re
import stat
import tarfile
import zipfile
import zlib
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path, PurePosixPath
from typing import IO, NoReturn, cast

from grader.submission.file_kinds import MOST_BYTES_OF, NOT_UNPACKED, OTHER_ARCHIVES, kind_of
from grader.submission.problems import AmbiguousProgram, Unreadable

#: The most files that can matter. What a build left behind does not count.
MOST_FILES = 400
MOST_BYTES = 4_000_000
#: The most entries of any kind.
MOST_ENTRIES = 50_000
#: The limit of a decompressed tar archive, and the most archives inside each other, and in all.
MOST_TAR_BYTES = 60_000_000
DEEPEST, MOST_ARCHIVES = 3, 50

ADVICE = "Hand in your code only, without what was built from it."
_OUTPUTS = (
    f"The notebook has more than {MOST_BYTES_OF['notebook'] // 1_000_000} MB, nearly all of them outputs. Clear them: "
    "in Jupyter, or with `jupyter nbconvert --clear-output --inplace FILE`."
)

#: Folders and files of version control, Python, colcon, editors and operating systems, which no student writes.
_NOISE = re.compile(
    r"__MACOSX|__pycache__|\..*|.*\.egg-info|node_modules|venv|env|site-packages|dist-packages|backups", re.IGNORECASE
)
_BUILT = ("build", "install", "log")
_FILES = re.compile(
    r"\..*|Thumbs\.db|desktop\.ini|Icon\r?|.*~|.*\.(?:py[cod]|so|o|a|pdf|png|jpe?g|gif|svg|mp4|mov|avi|mkv|webm|mcap|db3"
    r"|bag|docx?|pptx?|stl|dae|obj)",
    re.IGNORECASE,
)

#: What reading a damaged archive raises.
BROKEN: tuple[type[Exception], ...] = (
    *(zipfile.BadZipFile, tarfile.TarError, zlib.error, EOFError, RuntimeError, NotImplementedError, OSError),
    *(ValueError, ImportError),
)
with contextlib.suppress(ImportError):  # optional when Python is built
    from lzma import LZMAError

    BROKEN = (*BROKEN, LZMAError)


@dataclass
class Contents:
    """What is in a folder or an archive: contents by path, and the names of what could not be read."""

    files: dict[str, bytes] = field(default_factory=dict)
    damaged: list[str] = field(default_factory=list)
    links: list[str] = field(default_factory=list)
    archives: int = 0
    left: int = MOST_BYTES
    left_for_notebooks: int = MOST_BYTES_OF["notebook"]

    def add(self, name: str, data: bytes) -> None:
        """Keep a file. Raises `Unreadable` if that exceeds a limit, and `AmbiguousProgram` as `content_of`."""
        _refuse_pointer(name, data)
        if kind_of(name) == "notebook":  # a notebook's outputs may be large
            self.left_for_notebooks -= len(data)
        else:
            self.left -= len(data)
        if self.left < 0:
            raise Unreadable(f"It holds more than {MOST_BYTES // 1_000_000} MB. {ADVICE}")
        if self.left_for_notebooks < 0:
            raise AmbiguousProgram(_OUTPUTS)
        if len(self.files) >= MOST_FILES:
            raise Unreadable(f"It holds more than {MOST_FILES} files. {ADVICE}")
        if name in self.files:
            raise Unreadable(f"It holds two files called {name}. {ADVICE}")
        if _can_be_written(name, self.files):
            self.files[name] = data
        else:
            self.damaged.append(name)


def _can_be_written(name: str, files: Collection[str]) -> bool:
    """Return whether a file system can hold this path together with the others."""
    parts = name.split("/")
    sizes = [len(part.encode("utf-8", errors="replace")) for part in parts]
    above = ["/".join(parts[:count]) for count in range(1, len(parts))]
    is_text = name.encode("utf-8", errors="replace").decode() == name
    is_folder = any(other.startswith(f"{name}/") for other in files)
    return (
        is_text
        and max(sizes) <= 255
        and sum(sizes) <= 2000
        and not is_folder
        and not any(one in files for one in above)
    )


#: A path, and a function that reads it up to slightly more than a number of bytes; it returns None on failure.
_Entry = tuple[str, Callable[[int], "bytes | None"]]


def unpacked(content: bytes) -> Contents:
    """Return the contents of an archive and of the archives inside it. Raises `Unreadable`."""
    contents = Contents()
    _unpack(content, "", contents, 0)
    if contents.links and not contents.files:
        raise Unreadable(f"{contents.links[0]} in it is a symbolic link. Hand in the file itself.")
    return contents


def folder_contents(folder: Path) -> Contents:
    """Return the contents of a folder. Links are not followed. Raises `Unreadable`, and OSError."""
    contents, entries = Contents(), list[_Entry]()
    for place, folders, names in os.walk(folder, onerror=_raise):
        folders[:] = sorted(name for name in folders if not _NOISE.fullmatch(name))
        for path in (Path(place, name) for name in sorted(names)):
            inside = path.relative_to(folder).as_posix()
            if path.is_symlink():
                contents.links.append(inside)
            else:
                entries.append((inside, partial(_file, path)))
        if len(entries) > MOST_ENTRIES:
            raise Unreadable(f"It holds more than {MOST_ENTRIES:,} files. {ADVICE}")
    _keep(entries, "", contents, 0)
    return contents


def _raise(error: OSError) -> NoReturn:
    raise error


def _file(path: Path, most: int) -> bytes | None:
    try:
        return content_of(path, most + 1)
    except Unreadable:
        return None


def _keep(entries: Sequence[_Entry], prefix: str, contents: Contents, depth: int) -> None:
    """Read the entries that a student can have written."""
    environments = {name[: -len("pyvenv.cfg")] for name, _ in entries if name.rpartition("/")[2] == "pyvenv.cfg"}
    environments.discard("")
    meant = [one for one in entries if _is_meant(one[0]) and not one[0].startswith(tuple(environments))]
    own = [(name, load) for name, load in meant if not set(name.split("/")[:-1]) & set(_BUILT)]
    # What colcon built matters only if its source code is missing.
    meant = own if any(kind_of(name) in ("python", "notebook", "other language") for name, _ in own) else meant
    if len(meant) > MOST_FILES:
        raise Unreadable(f"It holds {len(meant)} files. {ADVICE}")
    for name, load in meant:
        most = contents.left_for_notebooks if kind_of(name) == "notebook" else contents.left
        _add(f"{prefix}{name}", load(most), contents, depth)


def content_of(path: Path, most: int) -> bytes:
    """Return the content of a regular file, without following links.

    Raises `Unreadable`, OSError, and `AmbiguousProgram` for what is no fault of the program: many outputs, or a pointer
    of Git LFS instead of the file.
    """
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
    except OSError as error:
        if error.errno == errno.ELOOP:
            raise Unreadable("It is a symbolic link. Hand in the file itself.") from None
        raise  # no fault of the student's
    try:
        if not stat.S_ISREG(os.fstat(descriptor).st_mode):
            raise Unreadable("It is not a regular file. Hand in a file.")
        with os.fdopen(descriptor, "rb", closefd=False) as file:
            content = file.read(most + 1)
    finally:
        os.close(descriptor)
    _refuse_pointer(path.name, content)
    if len(content) > most and kind_of(path.name) == "notebook":
        raise AmbiguousProgram(_OUTPUTS)
    if len(content) > most:
        raise Unreadable(f"It is larger than {most // 1_000_000} MB. Hand in your code only, with outputs cleared.")
    return content


def _refuse_pointer(name: str, content: bytes) -> None:
    if content.startswith(b"version https://git-lfs.github.com/") and kind_of(name) != "other":
        raise AmbiguousProgram(f"{name} is Git LFS's pointer to a file, not the file. Fetch it with `git lfs pull`.")


def _unpack(content: bytes, prefix: str, contents: Contents, depth: int) -> None:
    try:
        if is_tar(content):
            data = _decompressed(content)
            if b"\0" not in data[:512]:  # a single compressed file, such as node.py.gz
                contents.add(f"{prefix}compressed", data)
                return
            if data[-512:].strip(b"\0"):
                raise EOFError("it ends in the middle")
            with tarfile.open(fileobj=io.BytesIO(data), mode="r:") as tar:
                _keep(list(_of_tar(tar, contents)), prefix, contents, depth)
        else:
            with zipfile.ZipFile(io.BytesIO(content)) as archive:
                _keep(list(_of_zip(archive, contents)), prefix, contents, depth)
    except BROKEN as error:
        if content.startswith(OTHER_ARCHIVES):
            raise Unreadable(f"It is {NOT_UNPACKED}. Hand in a .zip file.") from None
        why = f": {error}" if is_tar(content) or content.startswith(b"PK") else ""
        kind = "archive" if is_tar(content) else "zip file" if why else "archive (.zip, .tar.gz, .tar)"
        raise Unreadable(f"It is not a valid {kind}{why}. Was the upload cut off? Hand it in again.") from None


def _add(name: str, data: bytes | None, contents: Contents, depth: int) -> None:
    if data is None:
        contents.damaged.append(name)
    elif kind_of(name) == "archive":
        contents.archives += 1
        if depth == DEEPEST or contents.archives > MOST_ARCHIVES:
            limit = f"{DEEPEST} archives inside each other" if depth == DEEPEST else f"{MOST_ARCHIVES} archives"
            raise Unreadable(f"It holds more than {limit}: {name}. {ADVICE}")
        try:
            _unpack(data, f"{name.rpartition('.')[0]}/", contents, depth + 1)
        except Unreadable as error:
            if "valid" not in str(error):
                raise
            contents.damaged.append(name)
    else:
        contents.add(name, data)


def _of_zip(archive: zipfile.ZipFile, contents: Contents) -> Iterator[_Entry]:
    entries = archive.infolist()
    if len(entries) > MOST_ENTRIES:
        raise Unreadable(f"It holds {len(entries)} files. {ADVICE}")
    for entry in entries:
        if stat.S_ISLNK(entry.external_attr >> 16):
            contents.links.append(path_inside(entry.filename))
        elif not entry.is_dir():
            yield path_inside(entry.filename), partial(_of_entry, archive, entry)


def _of_entry(archive: zipfile.ZipFile, entry: zipfile.ZipInfo, most: int) -> bytes | None:
    if entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        return None
    with contextlib.suppress(*BROKEN), archive.open(entry) as file:
        return file.read(most + 1)
    return None


def _of_tar(archive: tarfile.TarFile, contents: Contents) -> Iterator[_Entry]:
    for number, entry in enumerate(archive):
        if number >= MOST_ENTRIES:
            raise Unreadable(f"It holds more than {MOST_ENTRIES:,} files. {ADVICE}")
        if entry.issym() or entry.islnk():
            contents.links.append(path_inside(entry.name))
        elif entry.isfile():
            yield path_inside(entry.name), partial(of_member, archive, entry)


def of_member(archive: tarfile.TarFile, entry: tarfile.TarInfo, most: int) -> bytes | None:
    """Return slightly more than `most` bytes of a file in a tar; None for anything else."""
    file = archive.extractfile(entry)
    return file.read(most + 1) if file else None


def is_tar(start: bytes) -> bool:
    """Return whether a file that begins like this is a tar, or compressed as tars are."""
    return start.startswith((b"\x1f\x8b", b"BZh", b"\xfd7zXZ\x00")) or start[257:262] == b"ustar"


def decompressed(stream: IO[bytes], start: bytes) -> IO[bytes]:
    """Return what a file that begins with `start` contains, as a stream. Raises one of `BROKEN`."""
    if start.startswith(b"\x1f\x8b"):
        return cast("IO[bytes]", gzip.GzipFile(fileobj=stream))
    if start.startswith(b"BZh"):
        return bz2.BZ2File(stream)
    if start.startswith(b"\xfd7zXZ\x00"):
        import lzma

        return lzma.LZMAFile(stream)
    return stream


def _decompressed(content: bytes) -> bytes:
    try:
        if content.startswith(b"\xfd7zXZ\x00"):
            import lzma

            data = lzma.LZMADecompressor(memlimit=200_000_000).decompress(content, MOST_TAR_BYTES + 1)
        else:
            data = decompressed(io.BytesIO(content), content).read(MOST_TAR_BYTES + 1)
    except BROKEN as error:
        raise Unreadable(f"It is not a valid archive: {error}. Was the upload cut off? Hand it in again.") from None
    if len(data) > MOST_TAR_BYTES:
        raise Unreadable(f"It holds more than {MOST_TAR_BYTES // 1_000_000} MB. {ADVICE}")
    return data


def path_inside(name: str) -> str:
    """Return a name as a path that can't lead outside the archive."""
    parts = PurePosixPath(name.replace("\\", "/").replace("\0", "")).parts
    return "/".join(part for part in parts if part not in ("/", "..") and not part.endswith(":"))


def _is_meant(name: str) -> bool:
    """Return whether this is a student's file, and not one that file managers, editors or Python add."""
    *folders, file = name.split("/")
    if "install" in folders:  # colcon's copy of a package, which matters if its source code is missing
        folders = [folder for folder in folders if folder not in ("site-packages", "dist-packages")]
    return bool(file) and not any(map(_NOISE.fullmatch, folders)) and not _FILES.fullmatch(file)
