"""colcon workspaces near a folder, and the environment that their setup scripts would make."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, MutableMapping
from dataclasses import dataclass
from pathlib import Path

#: The folder that a course's packages are built in, beside its notebooks.
COURSE_WORKSPACE = "humanoid_ws"

_LAYOUT = ".colcon_install_layout"


@dataclass(frozen=True)
class Workspace:
    """A built colcon workspace: its `install` folder and the prefixes in it (one, or one a package)."""

    install: Path
    prefixes: tuple[Path, ...]

    def extend(self, environment: MutableMapping[str, str]) -> None:
        """Change `environment` as sourcing `install/setup.bash` would, as far as packages say it in .dsv files."""
        for prefix in reversed(self.prefixes):
            _prepend(environment, "AMENT_PREFIX_PATH", str(prefix))
            for package in sorted((prefix / "share").glob("*/package.dsv")):
                _apply(package, prefix, environment)
            for site in sorted(prefix.glob(f"lib/python{sys.version_info.major}.*/site-packages")):
                if site.parent.name == f"python{sys.version_info.major}.{sys.version_info.minor}":
                    _append(environment, "PYTHONPATH", str(site))


def near(folder: Path) -> list[Workspace]:
    """The built workspaces of `folder` and its parents, nearest first: the folder itself, then `humanoid_ws` in it."""
    folder = folder.absolute()
    found = (_built(place / "install") for at in (folder, *folder.parents) for place in (at, at / COURSE_WORKSPACE))
    return [workspace for workspace in found if workspace is not None]


def _built(install: Path) -> Workspace | None:
    try:
        layout = (install / _LAYOUT).read_text().strip()
    except OSError:
        return None
    if layout == "merged":
        return Workspace(install, (install,))
    prefixes = (folder for folder in install.iterdir() if (folder / "share" / folder.name).is_dir())
    return Workspace(install, tuple(sorted(prefixes)))


# The .dsv format is colcon's: an operation and its arguments in a line, divided by ';'.
# https://colcon.readthedocs.io/en/released/developer/environment.html


def _apply(file: Path, prefix: Path, environment: MutableMapping[str, str]) -> None:
    for operation, arguments in _operations(file):
        if operation == "source" and arguments[0].endswith(".dsv"):
            _apply(prefix / arguments[0], prefix, environment)
        elif operation in ("set", "set-if-unset") and len(arguments) == 2:
            if operation == "set" or arguments[0] not in environment:
                environment[arguments[0]] = arguments[1]
        elif operation.startswith("prepend-non-duplicate"):
            for value in _existing(operation, arguments[1:], prefix):
                _prepend(environment, arguments[0], value)
        elif operation.startswith("append-non-duplicate"):
            for value in _existing(operation, arguments[1:], prefix):
                _append(environment, arguments[0], value)


def _operations(file: Path) -> Iterator[tuple[str, list[str]]]:
    try:
        lines = file.read_text().splitlines()
    except OSError:
        return
    for line in lines:
        operation, *arguments = line.split(";")
        if arguments:
            yield operation, arguments


def _existing(operation: str, values: list[str], prefix: Path) -> list[str]:
    """The values as paths, relative ones below the prefix; only those that exist where the operation says so."""
    paths = [prefix / value if value else prefix for value in values or [""]]
    return [str(path) for path in paths if path.exists() or not operation.endswith("-if-exists")]


def _prepend(environment: MutableMapping[str, str], name: str, value: str) -> None:
    entries = [entry for entry in environment.get(name, "").split(os.pathsep) if entry and entry != value]
    environment[name] = os.pathsep.join([value, *entries])


def _append(environment: MutableMapping[str, str], name: str, value: str) -> None:
    entries = [entry for entry in environment.get(name, "").split(os.pathsep) if entry]
    if value not in entries:
        environment[name] = os.pathsep.join([*entries, value])
