"""What a recording may depend on that belongs to this machine and not to the exercise."""

from __future__ import annotations

import hashlib
import json
import os
import resource
import sys
from pathlib import Path

from grader.sandbox.environment import for_trusted
from grader.sandbox.program import Isolation


def machine_key(isolation: Isolation) -> str:
    """Return a digest of the kernel, this user's limits, Python with its packages, and the level of the sandbox.

    If it is another one than before, the solution must get full marks again before anybody else is graded.
    """
    kernel = os.uname()
    limits = [name for name in sorted(vars(resource)) if name.startswith("RLIMIT_")]
    text = {
        "kernel": (kernel.sysname, kernel.release, kernel.machine),
        "user": os.geteuid(),
        "limits": {name: resource.getrlimit(getattr(resource, name)) for name in limits},
        "python": (sys.executable, os.path.realpath(sys.executable), sys.version),
        "packages": _packages(),
        "environment": {
            name: sorted(value.split(os.pathsep)) for name, value in for_trusted().items() if name not in _OF_A_TERMINAL
        },
        "isolation": str(isolation),
    }
    return hashlib.sha256(json.dumps(text, sort_keys=True).encode()).hexdigest()


#: What differs from one terminal or run to the next, and changes nothing in a sandbox.
_OF_A_TERMINAL = (
    "PATH",
    "HOME",
    "USER",
    "LOGNAME",
    "TMPDIR",
    "SPINBOOK_CACHE",
    "XDG_CACHE_HOME",
    "OPENBLAS_NUM_THREADS",
)


def _packages() -> list[str]:
    """Return the names and versions of the installed packages: the names of the folders with their metadata."""
    folders = [Path(entry) for entry in sys.path if Path(entry).is_dir()]
    names = (file.name for folder in folders for file in folder.iterdir())
    return sorted({name for name in names if name.endswith((".dist-info", ".egg-info", ".pth"))})
