"""The one file that a student uploads: a zip with the code, the notebook it came from, and a record of both.

`submission.json`, the record, holds the SHA-256 of every other file and a digest of itself, so that a damaged or edited
upload is noticed. That is not a signature: anybody can write another record. So nothing in the record decides a grade.
"""

from __future__ import annotations

import hashlib
import io
import json
import stat
import zipfile
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import Any

FORMAT = "spinbook-submission 1"
RECORD = "submission.json"

#: The limits of an upload. A zip's own figures are not trusted: reading ends when these limits are reached.
MOST_FILES = 50
MOST_BYTES = 4_000_000

#: The same content gives the same bytes: every entry has this date, the earliest that a zip can name.
_DATE = (1980, 1, 1, 0, 0, 0)


ADVICE = "Hand in the file that `spinbook submit` writes."


class NoUpload(Exception):
    """Raised when a file is not a readable zip, or contains what no upload contains; tells the student why."""


@dataclass(frozen=True)
class Upload:
    """An upload, read. `faults` says what in it has changed since it was written, and is empty if everything matches.

    `files` are the contents by name, without the record; what could not be read is left out. `record` is empty if there
    is none.
    """

    record: dict[str, Any]
    files: dict[str, bytes]
    faults: tuple[str, ...]


def pack(record: Mapping[str, Any], files: Mapping[str, bytes]) -> bytes:
    """The upload's bytes. `record` must be plain JSON; the digests are added to it."""
    whole = {**record, "format": FORMAT, "files": {name: _sha256(files[name]) for name in sorted(files)}}
    whole["digest"] = record_digest(whole)
    text = json.dumps(whole, indent=2, ensure_ascii=False, sort_keys=True) + "\n"
    out = io.BytesIO()
    # Stored, not compressed: the output of a compressor depends on its version.
    with zipfile.ZipFile(out, "w", zipfile.ZIP_STORED) as archive:
        for name, content in [(RECORD, text.encode()), *((name, files[name]) for name in sorted(files))]:
            entry = zipfile.ZipInfo(name, _DATE)
            entry.create_system = 3
            entry.external_attr = (stat.S_IFREG | 0o644) << 16
            archive.writestr(entry, content)
    return out.getvalue()


def unpack(content: bytes) -> Upload:
    """What is in an upload. Nothing is written to disk. Raises `NoUpload`."""
    files, damaged = _entries(content)
    faults = [f"{name} is damaged" for name in damaged]
    record: dict[str, Any] = {}
    if RECORD in files:
        record = _record(files.pop(RECORD))
        faults += _differences(record, files, damaged)
    elif RECORD not in damaged:
        faults.append(f"{RECORD} is missing: `spinbook submit` has not written this file")
    return Upload(record, files, tuple(faults))


def record_digest(record: Mapping[str, Any]) -> str:
    """SHA-256 of a record without its `digest`. With the digests of the files in it, it covers everything."""
    kept = {key: value for key, value in record.items() if key != "digest"}
    return _sha256(json.dumps(kept, sort_keys=True, separators=(",", ":")).encode())


def _entries(content: bytes) -> tuple[dict[str, bytes], list[str]]:
    """The files, and the names of those that can't be read."""
    files: dict[str, bytes] = {}
    damaged: list[str] = []
    left = MOST_BYTES
    try:
        archive = zipfile.ZipFile(io.BytesIO(content))
    except (zipfile.BadZipFile, ValueError, OSError, NotImplementedError) as error:
        raise NoUpload(f"It is not a valid zip file: {error}. Was the upload cut off? Hand it in again.") from None
    with archive:
        entries = [entry for entry in archive.infolist() if _is_meant(entry)]
        if len(entries) > MOST_FILES:
            raise NoUpload(f"It holds {len(entries)} files. {ADVICE}")
        for entry in entries:
            # Where the file lay does not matter: some platforms put a folder around what was handed in.
            name = PurePosixPath(entry.filename.replace("\\", "/")).name
            if name in (*files, *damaged):
                raise NoUpload(f"It holds two files called {name}. {ADVICE}")
            data = _content(archive, entry, left)
            if data is None:
                damaged.append(name)
            else:
                files[name] = data
                left -= len(data)
    return files, damaged


def _is_meant(entry: zipfile.ZipInfo) -> bool:
    """Whether this is more than what file managers add by themselves."""
    parts = PurePosixPath(entry.filename).parts
    return not entry.is_dir() and "__MACOSX" not in parts and bool(parts) and not parts[-1].startswith("._")


def _content(archive: zipfile.ZipFile, entry: zipfile.ZipInfo, most: int) -> bytes | None:
    """The content of one entry, or None if it can't be read."""
    if stat.S_ISLNK(entry.external_attr >> 16):
        raise NoUpload(f"{entry.filename} in it is a symbolic link. Hand in the file itself.")
    if entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        return None
    try:
        with archive.open(entry) as file:
            data = file.read(most + 1)
    except (zipfile.BadZipFile, zlib.error, EOFError, RuntimeError, NotImplementedError, OSError, ValueError):
        return None
    if len(data) > most:
        raise NoUpload(f"It holds more than {MOST_BYTES // 1_000_000} MB. {ADVICE}")
    return data


def _record(content: bytes) -> dict[str, Any]:
    try:
        record = json.loads(content)
        record_digest(record)
    except (ValueError, AttributeError, RecursionError):
        return {}
    return record if isinstance(record, dict) else {}


def _differences(record: dict[str, Any], files: Mapping[str, bytes], damaged: list[str]) -> list[str]:
    if record.get("format") != FORMAT:
        return [f"{RECORD} can't be read, or another version of Spinbook has written it"]
    listed = record.get("files")
    listed = listed if isinstance(listed, dict) else {}
    faults = [f"{name} has been added" for name in sorted(set(files) - set(listed))]
    faults += [f"{name} is missing" for name in sorted(set(listed) - set(files) - set(damaged))]
    faults += [
        f"{name} has been changed" for name in sorted(files) if name in listed and _sha256(files[name]) != listed[name]
    ]
    if record_digest(record) != record.get("digest"):
        faults.append(f"{RECORD} has been changed")
    return faults


def _sha256(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
