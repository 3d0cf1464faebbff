"""Compiles what a page imports at its start. Runs in Node.js when a site is made, so that no page does it."""

from __future__ import annotations

import importlib.util
import marshal
import sys
import zipfile
from pathlib import Path

#: The archives as a page names them in tracebacks, and their names in the site.
_STDLIB = f"/lib/python{sys.version_info.major}{sys.version_info.minor}.zip"
_ARCHIVES = {_STDLIB: "python_stdlib.zip", "/ros.zip": "ros.zip"}
#: The flags, in four bytes, of a compiled module whose source nobody looks for (PEP 552).
_UNCHECKED = b"\1\0\0\0"


def compile_imported(folder: str) -> None:
    """Write each archive into `folder`, in which the modules that have been imported are compiled."""
    imported = {getattr(module, "__file__", None) for module in list(sys.modules.values())}
    target = Path("/compiled.zip")
    for place, name in _ARCHIVES.items():
        with zipfile.ZipFile(place) as archive, zipfile.ZipFile(target, "w") as compiled:
            for item in archive.infolist():
                data, path = archive.read(item), f"{place}/{item.filename}"
                # The __file__ of a compiled module is not the file of its frames, and rclpy's logs compare the two.
                if path in imported and not (b"__file__" in data and name == "ros.zip"):
                    item.filename += "c"
                    data = _compiled(data, path)
                compiled.writestr(item, data)
        Path(folder, name).write_bytes(target.read_bytes())


def _compiled(source: bytes, path: str) -> bytes:
    code = marshal.dumps(compile(source, path, "exec", dont_inherit=True))
    return importlib.util.MAGIC_NUMBER + _UNCHECKED + importlib.util.source_hash(source) + code
