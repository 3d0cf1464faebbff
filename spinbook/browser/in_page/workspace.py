"""The chapter's package as files: what its cells have written, for programs and commands to read."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

#: A terminal's current folder in the page, as after `cd` into the workspace.
FOLDER = Path("/workspace")
_PREFIX = Path("/opt/ros")


def put(files: Mapping[str, str], package: str) -> None:
    """Write the package's files (path within it -> text): in the workspace, and where a package is installed."""
    share = _PREFIX / "share"
    _write(share / "ament_index" / "resource_index" / "packages" / package, "")
    for path, text in files.items():
        _write(FOLDER / "src" / package / path, text)
        _write(share / package / path, text)
    os.chdir(FOLDER)
    os.environ["AMENT_PREFIX_PATH"] = os.fspath(_PREFIX)


def _write(file: Path, text: str) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text, encoding="utf-8")
