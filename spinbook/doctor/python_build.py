"""Detects whether this Python was compiled with optimizations, and looks for a faster build of its version.

A Python with profile-guided optimization runs programs about 25 % faster. Linux distributions, python.org's container
images, conda and uv use it; pyenv does only on request.

This is also a program, with only the standard library, that `make setup` runs before anything is installed: it prints
the path of a faster build, if there is one. With `--describe`, it prints a description of this Python as JSON.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import sysconfig
from dataclasses import asdict, dataclass
from importlib.util import find_spec
from pathlib import Path

#: A Python that takes longer than this to describe itself is skipped (s).
_TIME_LIMIT_S = 20.0


@dataclass(frozen=True)
class PythonBuild:
    """A Python installation. It is `complete` if it has what an environment needs: venv, ensurepip and Python.h."""

    executable: str
    version: str
    optimized: bool
    complete: bool


def this_build() -> PythonBuild:
    """Return a description of the running Python."""
    modules = all(find_spec(module) for module in ("venv", "ensurepip"))
    headers = Path(sysconfig.get_path("include"), "Python.h").is_file()
    # In an active environment, describe the Python from which it was made.
    executable = getattr(sys, "_base_executable", sys.executable)
    version = "{}.{}".format(*sys.version_info[:2])
    return PythonBuild(executable, version, is_optimized(), modules and headers)


def is_optimized() -> bool:
    """Return whether this Python was compiled with profile-guided optimization.

    Distributions always use it for the Python in /usr; for all others, configure's arguments say so.
    """
    return sys.base_prefix == "/usr" or "--enable-optimizations" in str(sysconfig.get_config_var("CONFIG_ARGS"))


def faster_build(this: PythonBuild, path: str) -> str | None:
    """Return the first Python on `path` that is a faster build of the same version as `this`; None if there is none."""
    if this.optimized:
        return None
    others = (_described(folder, this.version) for folder in path.split(os.pathsep))
    return next((other.executable for other in others if other and other.optimized and other.complete), None)


def _described(folder: str, version: str) -> PythonBuild | None:
    """Return the Python of this version in a folder; None if there is none, or if it does not run."""
    program = Path(folder, f"python{version}")
    if not program.is_file():
        return None
    try:
        done = subprocess.run(
            [program, "-I", __file__, "--describe"], capture_output=True, timeout=_TIME_LIMIT_S, check=True
        )
        return PythonBuild(**json.loads(done.stdout))
    except (OSError, subprocess.SubprocessError, ValueError, TypeError):
        return None


if __name__ == "__main__":
    here = this_build()
    print(
        json.dumps(asdict(here)) if "--describe" in sys.argv else faster_build(here, os.environ.get("PATH", "")) or ""
    )
