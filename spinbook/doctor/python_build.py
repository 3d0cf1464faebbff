"""Whether this Python was compiled with optimizations, and where a faster build of its version is.

A Python that was compiled with profile-guided optimization runs programs a quarter faster. Those of Linux
distributions, python.org's container images, conda and uv are; pyenv leaves it out unless it is asked for it.

Also a program, which set-up runs with the bare Python before anything is installed (standard library only):
it prints the path of a faster build, if there is one. With `--describe` it prints what this Python is, as JSON.
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

#: A Python that takes longer to start is not asked further (s).
_PATIENCE_S = 20.0


@dataclass(frozen=True)
class PythonBuild:
    """A Python. An environment can be made from it if it is `complete`: with venv, ensurepip and Python.h."""

    executable: str
    version: str
    optimized: bool
    complete: bool


def this_build() -> PythonBuild:
    """The Python that runs this."""
    modules = all(find_spec(module) for module in ("venv", "ensurepip"))
    headers = Path(sysconfig.get_path("include"), "Python.h").is_file()
    # In an active environment, the Python that it was made from.
    executable = getattr(sys, "_base_executable", sys.executable)
    version = "{}.{}".format(*sys.version_info[:2])
    return PythonBuild(executable, version, is_optimized(), modules and headers)


def is_optimized() -> bool:
    """Whether this Python was compiled with profile-guided optimization.

    Distributions have rules of their own for theirs, in /usr; all others name it in configure's arguments.
    """
    return sys.base_prefix == "/usr" or "--enable-optimizations" in str(sysconfig.get_config_var("CONFIG_ARGS"))


def faster_build(this: PythonBuild, path: str) -> str | None:
    """Return the first Python on `path` that is a faster build of the same version as `this`; None if there is none."""
    if this.optimized:
        return None
    others = (_described(folder, this.version) for folder in path.split(os.pathsep))
    return next((other.executable for other in others if other and other.optimized and other.complete), None)


def _described(folder: str, version: str) -> PythonBuild | None:
    """The Python of this version in a folder; None if it has none that answers."""
    program = Path(folder, f"python{version}")
    if not program.is_file():
        return None
    try:
        answer = subprocess.run(
            [program, "-I", __file__, "--describe"], capture_output=True, timeout=_PATIENCE_S, check=True
        )
        return PythonBuild(**json.loads(answer.stdout))
    except (OSError, subprocess.SubprocessError, ValueError, TypeError):
        return None


if __name__ == "__main__":
    here = this_build()
    print(
        json.dumps(asdict(here)) if "--describe" in sys.argv else faster_build(here, os.environ.get("PATH", "")) or ""
    )
