"""Finding what `ros2 run` starts: in ROS prefixes, in a colcon workspace near by, and what Spinbook brings itself."""

from __future__ import annotations

import os
import sys
from dataclasses import dataclass
from pathlib import Path

from spinbook.ros2 import prefixes, workspace
from spinbook.ros2.bootstrap import without_bootstrap
from spinbook.ros2.refusal import Refusal

#: Package -> executable -> the module that is it. Used where the package has no executables: of turtlesim, set-up
#: compiles the messages alone.
BUILT_IN = {
    "turtlesim": {
        "draw_square": "spinbook.turtlesim.draw_square",
        "mimic": "spinbook.turtlesim.mimic",
        "turtle_teleop_key": "spinbook.turtlesim.teleop_key",
        "turtlesim_node": "spinbook.turtlesim.node",
    }
}


@dataclass(frozen=True)
class Launch:
    """How to start an executable: the command (append the arguments for the node) and its whole environment."""

    argv: list[str]
    env: dict[str, str]


def find(package: str, executable: str, cwd: Path) -> Launch:
    """How to start a package's executable from the folder `cwd`.

    Searched are, in this order, the prefixes of AMENT_PREFIX_PATH and of this Python, the colcon workspaces of `cwd`
    and its parents, and what Spinbook brings. A workspace's environment is made as its setup scripts would make it,
    so it need not be sourced. Raises `Refusal` with what is there if the package or the executable is not.
    """
    environment = without_bootstrap(os.environ)
    prefix = prefixes.prefix_of(package, prefixes.installed())
    if prefix is None:
        for near in workspace.near(cwd):
            prefix = prefixes.prefix_of(package, near.prefixes)
            if prefix is not None:
                near.extend(environment)
                break
    there = in_prefix(prefix, package) if prefix is not None else []
    if there or (prefix is not None and package not in BUILT_IN):
        return Launch([str(_only(there, package, executable))], environment)
    modules = BUILT_IN.get(package)
    if modules is None:
        raise Refusal(
            f"Package '{package}' not found",
            _where(cwd),
            f"Packages to run from here: {', '.join(runnable(cwd))}.",
        )
    if executable not in modules:
        raise Refusal("No executable found", f"Executables of {package}: {', '.join(sorted(modules))}.")
    return Launch([sys.executable, "-m", modules[executable]], environment)


def is_built_in(package: str, prefix: Path | None) -> bool:
    """Whether Spinbook's own executables of a package are used: those of its prefix come first."""
    return package in BUILT_IN and (prefix is None or not in_prefix(prefix, package))


def in_prefix(prefix: Path, package: str) -> list[Path]:
    """The executables that a package installed in a prefix, in its folder below `lib`, sorted by path."""
    found = []
    for folder, folders, files in os.walk(prefix / "lib" / package):
        folders[:] = sorted(name for name in folders if not name.startswith("."))
        found += [Path(folder, name) for name in sorted(files) if os.access(Path(folder, name), os.X_OK)]
    return found


def everywhere(cwd: Path) -> dict[str, Path]:
    """Package -> prefix of all packages that `find` would search, without those that Spinbook brings."""
    places = [*prefixes.installed(), *(prefix for near in workspace.near(cwd) for prefix in near.prefixes)]
    return dict(sorted(prefixes.packages(places).items()))


def runnable(cwd: Path) -> list[str]:
    """The packages of near workspaces that have an executable, and those that Spinbook brings, sorted."""
    built = prefixes.packages(prefix for near in workspace.near(cwd) for prefix in near.prefixes)
    return sorted({package for package, prefix in built.items() if in_prefix(prefix, package)} | set(BUILT_IN))


def _only(paths: list[Path], package: str, executable: str) -> Path:
    named = [path for path in paths if path.name == executable]
    if len(named) > 1:
        raise Refusal("Multiple executables found:", *(f"- {path}" for path in named))
    if not named:
        there = ", ".join(path.name for path in paths)
        raise Refusal(
            "No executable found",
            f"Executables of {package}: {there or 'none'}.",
            "A Python package names its executables under console_scripts in setup.py; build again after a change.",
        )
    return named[0]


def _where(cwd: Path) -> str:
    built = workspace.near(cwd)
    if built:
        places = ", ".join(str(near.install) for near in built)
        return f"Looked in ROS 2 itself and in {places}: is its name right, and is it built?"
    return (
        "There is no built workspace here: run `colcon build --symlink-install` in the workspace, and this from there."
    )
