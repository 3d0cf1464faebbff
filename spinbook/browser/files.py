"""The files that a site needs so that its pages can run their own nodes."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from spinbook.browser.archives import check_archive, ros_archive, share_archive
from spinbook.browser.pyodide import pyodide_files, pyodide_folder

#: Where they lie in the site.
FOLDER = "run"
_STATIC = Path(__file__).with_name("static")


def can_run() -> bool:
    """Whether pages can run nodes: Pyodide is there."""
    return pyodide_folder() is not None


def run_files(exercises: Mapping[str, bytes]) -> dict[str, str | bytes]:
    """The files: path in the site -> content; none where Pyodide is missing.

    `exercises` are the public parts of the course's exercises: path in the archive of checks -> content.
    """
    folder = pyodide_folder()
    if folder is None:
        return {}
    files: dict[str, bytes] = pyodide_files(folder)
    files |= {file.name: file.read_bytes() for file in sorted(_STATIC.iterdir())}
    files |= {"ros.zip": ros_archive(), "share.zip": share_archive(), "check.zip": check_archive(exercises)}
    return {f"{FOLDER}/{name}": data for name, data in files.items()}
