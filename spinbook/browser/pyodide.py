"""Pyodide, CPython for web pages: where set-up put it, and which files of it a page needs.

https://pyodide.org, Mozilla Public License 2.0; from its npm package, whose digest is pinned in fetch-pyodide.sh.
"""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

#: What a page loads of it. Its own list of packages is left out: no package is ever fetched.
FILES = ("pyodide.mjs", "pyodide.asm.mjs", "pyodide.asm.wasm", "python_stdlib.zip")
_LOCK = "pyodide-lock.json"
_FOLDER = Path("share", "spinbook", "pyodide")


def pyodide_folder() -> Path | None:
    """The folder of the package, or None where set-up could not fetch it. SPINBOOK_PYODIDE names another one."""
    folder = Path(os.environ.get("SPINBOOK_PYODIDE") or Path(sys.prefix) / _FOLDER)
    return folder if all((folder / name).is_file() for name in (*FILES, _LOCK)) else None


def pyodide_files(folder: Path) -> dict[str, bytes]:
    """The files of the package as a page gets them: name -> content."""
    found = {name: (folder / name).read_bytes() for name in FILES}
    lock = json.loads((folder / _LOCK).read_text(encoding="utf-8"))
    found[_LOCK] = json.dumps({"info": lock["info"], "packages": {}}).encode()
    return found
