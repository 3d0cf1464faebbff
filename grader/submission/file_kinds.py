"""Determines what a file is from its name and its first bytes: Python, a notebook, an archive, or another language."""

from __future__ import annotations

import re
from typing import Literal

Kind = Literal["python", "notebook", "archive", "c++", "other"]

_SUFFIXES: dict[str, Kind] = {
    ".py": "python",
    ".pyw": "python",
    ".ipynb": "notebook",
    ".zip": "archive",
    ".tar": "archive",
    ".tgz": "archive",
    ".tar.gz": "archive",
    ".tar.bz2": "archive",
    ".tar.xz": "archive",
    ".txz": "archive",
    **dict.fromkeys((".cpp", ".cc", ".cxx", ".c++", ".hpp", ".hh", ".hxx"), "c++"),
}

#: What browsers, mail programs and editors append to a file's name.
_ADDED = re.compile(
    r"(?:\.(?:txt|text|json|download|bin|zip\.zip|py\.py))+$|(?: \(\d+\)| - copy| copy)$", re.IGNORECASE
)

#: The largest submission of each kind (bytes).
MOST_BYTES_OF: dict[Kind, int] = {
    "python": 1_000_000,
    "notebook": 30_000_000,
    "archive": 30_000_000,
    "c++": 1_000_000,
    "other": 1_000_000,
}

_ARCHIVES = (b"PK\x03\x04", b"PK\x05\x06", b"\x1f\x8b", b"BZh", b"\xfd7zXZ\x00")
#: RAR and 7z, which Python can't unpack.
OTHER_ARCHIVES = (b"Rar!\x1a\x07", b"7z\xbc\xaf\x27\x1c")

NEITHER = "neither Python, nor a notebook, nor an archive"


def kind_of(name: str) -> Kind:
    """Return the kind of a file by its name, ignoring case and what a browser appended: `node.py.txt`."""
    lower = name.rpartition("/")[2].strip().lower()
    while True:
        for suffix, kind in _SUFFIXES.items():
            if lower.endswith(suffix):
                return kind
        shorter = _ADDED.sub("", lower)
        if shorter == lower:
            return "other"
        lower = shorter


def can_be_read(name: str) -> bool:
    """Return whether a file with this name is a submission, even one that is refused for its language."""
    return kind_of(name) != "other"


def kind_of_content(content: bytes, kind: Kind) -> Kind:
    """Return the kind by a file's content, such as a notebook that was saved as .py, or a zip as .ipynb."""
    if content.startswith(_ARCHIVES):
        return "archive"
    if kind == "other" and content.lstrip()[:1] != b"{":
        return kind
    cells = re.search(rb'"(?:cells|worksheets)"\s*:', content)
    if kind in ("python", "other") and content.lstrip()[:1] == b"{" and cells:
        return "notebook"
    return kind
