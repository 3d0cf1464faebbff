"""Zip archives that have the same bytes whenever they contain the same files."""

from __future__ import annotations

import io
import stat
import zipfile
from collections.abc import Mapping

#: The earliest moment that a zip can contain.
_DATE = (1980, 1, 1, 0, 0, 0)


def zipped(files: Mapping[str, bytes], last: str = "") -> bytes:
    """Return an archive of `files`, sorted by name; `last` names one that goes to the end."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        for name in sorted(files, key=lambda name: (name == last, name)):
            entry = zipfile.ZipInfo(name, _DATE)
            entry.create_system = 3
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (stat.S_IFREG | 0o644) << 16
            archive.writestr(entry, files[name])
    return out.getvalue()
