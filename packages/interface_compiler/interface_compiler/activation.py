"""Lets this process, and its child processes, import compiled packages and find their definitions."""

from __future__ import annotations

import importlib
import os
import sys
from collections.abc import Iterable, MutableMapping
from pathlib import Path

from interface_compiler.prefixes import PYTHON

#: The environment variable, in every process that uses prefixes, that lists them.
VARIABLE = "COMPILED_INTERFACES"


def active() -> list[Path]:
    """Return the prefixes in use that still exist."""
    named = os.environ.get(VARIABLE, "").split(os.pathsep)
    return [Path(entry) for entry in named if entry and Path(entry).is_dir()]


def activate(prefix: Path, instead_of: Iterable[Path] = ()) -> None:
    """Use the packages in `prefix` from now on, also in child processes, and stop using those in `instead_of`.

    A package that this process has already imported stays as it is: see `imported`.
    """
    extend(os.environ, prefix, instead_of)
    gone = {str(old / PYTHON) for old in instead_of}
    sys.path[:] = [entry for entry in sys.path if entry not in gone]
    if str(prefix / PYTHON) not in sys.path:
        # Before what is installed: a project's newer text takes precedence.
        sys.path.insert(0, str(prefix / PYTHON))
    importlib.invalidate_caches()


def extend(environment: MutableMapping[str, str], prefix: Path, instead_of: Iterable[Path] = ()) -> None:
    """Change `environment` so that processes started with it use the packages in `prefix`."""
    gone = [*instead_of, prefix]
    for variable, folder in ((VARIABLE, Path()), ("AMENT_PREFIX_PATH", Path()), ("PYTHONPATH", PYTHON)):
        unwanted = {str(old / folder) for old in gone}
        entries = [entry for entry in environment.get(variable, "").split(os.pathsep) if entry]
        kept = [entry for entry in entries if entry not in unwanted]
        environment[variable] = os.pathsep.join([str(prefix / folder), *kept])


def imported(packages: Iterable[str], prefix: Path) -> list[str]:
    """Return those of these packages that this process has imported from elsewhere than `prefix`."""
    own = str(prefix / PYTHON)
    loaded = ((name, sys.modules[name]) for name in packages if name in sys.modules)
    return [name for name, module in loaded if not str(getattr(module, "__file__", "")).startswith(own)]
