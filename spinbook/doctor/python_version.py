"""Whether this Python is one that Spinbook runs on."""

from __future__ import annotations

import platform
import sys

from spinbook.doctor.finding import Finding, missing, ok

OLDEST, NEWEST = (3, 10), (3, 14)


def examine(name: str) -> Finding:
    """Look at the version of the Python that runs this."""
    found = f"{platform.python_implementation()} {platform.python_version()}, {sys.executable}"
    if OLDEST <= sys.version_info[:2] <= NEWEST and platform.python_implementation() == "CPython":
        return ok(name, found)
    return missing(name, found, "Spinbook needs CPython 3.10 to 3.14. Name one: make PYTHON=python3.12 setup")
