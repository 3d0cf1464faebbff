"""The one file that a student uploads: a zip with the code, the notebook it came from, and a record of both.

`submission.json`, the record, has the SHA-256 of every other file and a digest of itself, so that a damaged or edited
upload is noticed. It is not a signature: anyone can write another record. So no grade depends on the record.
"""

from __future__ import annotations

import hashlib
import io
import json
import stat
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from grader.submission.archive import Contents, unpacked

FORMAT = "spinbook-submission 1"
RECORD = "submission.json"

#: The same content gives the same bytes: every entry has this date, the earliest that a zip can contain.
_DATE = (1980, 1, 1, 0, 0, 0)


@dataclass(frozen=True)
class Upload:
    """The contents of an upload. `faults` says what has changed since it was written.

    `contents` are its files without the record. `record` is empty if it can't be read or is missing, because the
    upload was packed by hand and not by `spinbook submit`.
    """

    record: dict[str, Any]
    contents: Contents
    faults: tuple[str, ...]
    has_record: bool = True

    @property
    def files(self) -> dict[str, bytes]:
        """The contents by name, without files that could not be read."""
        return self.contents.files


def pack(record: Mapping[str, Any], files: Mapping[str, bytes]) -> bytes:
    """Return the upload's bytes. `record` must be plain JSON; the digests are added to it."""
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
    """Return what is in an upload. Nothing is written to disk. Raises `Unreadable`."""
    contents = unpacked(content)
    # Some platforms add a folder around the files.
    place = min((name for name in contents.files if name.rpartition("/")[2] == RECORD), key=len, default="")
    folder = place[: -len(RECORD)]
    packed = contents.files.pop(place, None)
    contents.files = {name.removeprefix(folder): data for name, data in contents.files.items()}
    contents.damaged = [name.removeprefix(folder) for name in contents.damaged]
    faults = [f"{name} is damaged" for name in contents.damaged]
    if packed is None:
        return Upload({}, contents, tuple(faults), False)
    record = _record(packed)
    return Upload(record, contents, (*faults, *_differences(record, contents.files, contents.damaged)))


def record_digest(record: Mapping[str, Any]) -> str:
    """Return the SHA-256 of a record without its `digest`. It covers the files by their digests."""
    kept = {key: value for key, value in record.items() if key != "digest"}
    return _sha256(json.dumps(kept, sort_keys=True, separators=(",", ":")).encode())


def _record(content: bytes) -> dict[str, Any]:
    try:
        record = json.loads(content)
        record_digest(record)
    except (ValueError, AttributeError, RecursionError):
        return {}
    return record if isinstance(record, dict) else {}


def _differences(record: dict[str, Any], files: Mapping[str, bytes], damaged: list[str]) -> list[str]:
    if record.get("format") != FORMAT:
        return [f"{RECORD} can't be read, or was written by another version of Spinbook"]
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
