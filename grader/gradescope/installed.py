"""The wheel from which this software is installed, put together again from its files, and what it runs with.

A wheel is a zip whose RECORD lists every file with its hash (PEP 427, and "Recording installed projects").
"""

from __future__ import annotations

import re
from importlib import metadata
from pathlib import Path

from interface_compiler.archive import zipped
from interface_compiler.wheel import record

NAME = "spinbook"

#: What the installer adds to a wheel's own files.
_INSTALLERS = ("INSTALLER", "REQUESTED", "direct_url.json", "RECORD")


class NotInstalled(Exception):
    """Raised where this software is not installed from a wheel; says what to do."""


def installed_wheel() -> tuple[str, bytes]:
    """Return the wheel's file name and content. Raises `NotInstalled`."""
    try:
        distribution = metadata.distribution(NAME)
    except metadata.PackageNotFoundError:
        raise NotInstalled(f"{NAME} is not installed here: pip install {NAME}") from None
    files = {}
    for file in distribution.files or ():
        name = file.as_posix()
        if not name.startswith("..") and "__pycache__" not in name and name.rpartition("/")[2] not in _INSTALLERS:
            files[name] = Path(str(distribution.locate_file(file))).read_bytes()
    if "grader/__init__.py" not in files:
        raise NotInstalled(f"{NAME} is installed neither from a wheel nor in a checkout: pip install it from a wheel.")
    listing = f"{NAME}-{distribution.version}.dist-info/RECORD"
    files[listing] = record(files, listing)
    return f"{NAME}-{distribution.version}-py3-none-any.whl", zipped(files, last=listing)


def pins() -> list[str]:
    """Return the versions, such as `numpy==2.3.1`, of what is installed here of all that the wheel may need."""
    found: dict[str, str] = {}
    waiting = [NAME]
    while waiting:
        name = re.sub(r"[-_.]+", "-", waiting.pop()).lower()  # PEP 503, "Normalized Names"
        if name in found:
            continue
        try:
            distribution = metadata.distribution(name)
        except metadata.PackageNotFoundError:
            continue
        found[name] = distribution.version
        waiting += [match[0] for line in distribution.requires or () if (match := re.match(r"[\w.-]+", line))]
    return sorted(f"{name}=={version}" for name, version in found.items() if name != NAME)
