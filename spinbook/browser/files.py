"""The files that a site needs so that its pages can run their own nodes."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

from spinbook.browser.archives import check_archive, ros_archive, share_archive
from spinbook.browser.pyodide import pyodide_files, pyodide_folder
from spinbook.build.digest import digest

#: Where they lie in the site.
FOLDER = "run"
_OFFLINE, _LIST = "offline.js", "files.json"
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
    # A service worker answers for its own folder and what is below.
    at_the_top = {_OFFLINE: files.pop(_OFFLINE)}
    files |= {"ros.zip": ros_archive(), "share.zip": share_archive(), "check.zip": check_archive(exercises)}
    files[_LIST] = _listed(files)
    return {**at_the_top, **{f"{FOLDER}/{name}": data for name, data in files.items()}}


def _listed(files: Mapping[str, bytes]) -> bytes:
    """What there is to load, for the page: each file's size in bytes, and a version that changes with any of them."""
    version = digest(*(part for name in sorted(files) for part in (name, files[name])))[:16]
    return json.dumps({"version": version, "files": {name: len(files[name]) for name in sorted(files)}}).encode()
