"""The student's name, asked once and kept in the folder."""

from __future__ import annotations

from pathlib import Path

from spinbook.written import write_if_changed

FILE = Path(".spinbook") / "student"

#: No name is longer; whatever is, is a mistake.
LONGEST = 200


def known(folder: Path) -> str | None:
    """The name kept in `folder` or in one above it: empty where the student gave none, None where nobody asked yet."""
    for place in (folder, *folder.parents):
        try:
            return (place / FILE).read_text(encoding="utf-8").strip()[:LONGEST]
        except (OSError, UnicodeDecodeError):
            continue
    return None


def keep(name: str, folder: Path) -> str:
    """Keep a name in `folder`; returns it as it is kept, on one line."""
    kept = " ".join(name.split())[:LONGEST]
    write_if_changed(folder / FILE, kept + "\n")
    return kept
