"""What was compiled for a project earlier: found from a folder in it, and used by this process."""

from __future__ import annotations

import os
from pathlib import Path

from interface_compiler import activation
from interface_compiler.prefixes import PYTHON

#: A project's store, relative to the project's folder.
STORE = Path("build", "interfaces")
#: The file in the store's folder that names the newest prefix.
CURRENT = "current"


def make_current(folder: Path, prefix: Path) -> None:
    """Note which of a store's prefixes is in use, for processes that start later."""
    new = folder / f".{CURRENT}-{os.getpid()}"
    new.write_text(prefix.name + "\n", encoding="utf-8")
    new.replace(folder / CURRENT)


def use(prefix: Path, folder: Path) -> None:
    """Use a store's prefix in this process and its child processes, instead of earlier ones of the same store."""
    earlier = [old for old in activation.active() if old.parent == folder.resolve() and old != prefix]
    activation.activate(prefix, earlier)


def current(folder: Path) -> Path | None:
    """Return the prefix that was made current in a store, if it exists and is for this version of Python."""
    try:
        name = (folder / CURRENT).read_text(encoding="utf-8").strip()
    except OSError:
        return None
    prefix = folder.resolve() / name
    return prefix if name and (prefix / PYTHON).is_dir() else None


def use_near(start: Path, marker: str | None = None) -> Path | None:
    """Use what was compiled for the project that contains the folder `start`; return the prefix, if there is one.

    The project is the nearest folder that has the file `marker`, or, without a marker, that has a store.
    """
    for project in (start.absolute(), *start.absolute().parents):
        if (project / (marker or STORE)).exists():
            prefix = current(project / STORE)
            if prefix is not None:
                use(prefix, project / STORE)
            return prefix
    return None
