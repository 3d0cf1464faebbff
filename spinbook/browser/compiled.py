"""Compiles what every page imports before its first program, so that readers wait half as long for it."""

from __future__ import annotations

import contextlib
import os
import subprocess
import tempfile
from collections.abc import Mapping
from pathlib import Path

from groundwork.child_process import run_program
from groundwork.files import cached, write_folder, write_if_changed
from spinbook.build.digest import digest

_SCRIPT = Path(__file__).with_name("compile.mjs")
_TIME_LIMIT_S = 300


def with_compiled_modules(pyodide: Path, archives: Mapping[str, bytes]) -> dict[str, bytes]:
    """Return the archives, name -> content, with compiled modules; unchanged if Node.js is missing or too old for
    Pyodide: pages then compile for themselves. npm, which fetches Pyodide, comes with Node.js.
    """
    kept = cached("pages") / digest(_SCRIPT.read_bytes(), *archives.values())[:24]
    with contextlib.suppress(OSError):  # not compiled yet
        return {name: (kept / name).read_bytes() for name in archives}
    with tempfile.TemporaryDirectory(prefix="spinbook-") as folder:
        write_folder(Path(folder), archives)
        if not _compiles(pyodide, folder):
            return dict(archives)
        compiled = {name: Path(folder, name).read_bytes() for name in archives}
    with contextlib.suppress(OSError):  # a cache that can't be written keeps nothing
        for name, content in compiled.items():
            write_if_changed(kept / name, content)
    return compiled


def _compiles(pyodide: Path, folder: str) -> bool:
    argv = ["node", os.fspath(_SCRIPT), os.fspath(pyodide.absolute()), folder]
    try:
        return run_program(argv, _TIME_LIMIT_S).returncode == 0
    except (OSError, subprocess.TimeoutExpired):
        return False
