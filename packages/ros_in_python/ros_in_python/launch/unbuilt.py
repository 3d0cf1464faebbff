"""Launches a file whose packages are not built: what `colcon build` would install is linked into a folder."""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from ros_in_python.launch.command import launch_file
from ros_in_python.ros2.cli import CommandError

#: An executable of a package: runs a function of a module, or without a module a whole file.
_SCRIPT = """\
#!{python}
import importlib, operator, runpy, sys

sys.path[0] = {folder!r}
if {module!r}:
    sys.exit(operator.attrgetter({function!r})(importlib.import_module({module!r}))())
runpy.run_path({file!r}, run_name="__main__")
"""


@dataclass(frozen=True)
class UnbuiltExecutable:
    """What an executable runs: `function` of `module`, or without a module `file`; `folder` is on Python's path."""

    file: str
    folder: str
    module: str = ""
    function: str = ""


@dataclass(frozen=True)
class UnbuiltPackage:
    """A package's folder, in which all that it shares is, such as launch and config; and its executables by name."""

    folder: str
    executables: Mapping[str, UnbuiltExecutable]


def launch_unbuilt(file: str, packages: Mapping[str, UnbuiltPackage], here: Path, words: Sequence[str]) -> int:
    """Launch a file, with simulated time for all nodes; return the exit code of `ros2 launch`.

    All paths are below `here`. `words` are the launch arguments, up to `--ros-args`. Raises `RuntimeError` with the
    file and the line if it can't be launched.
    """
    arguments = dict(word.split(":=", 1) for word in words[: [*words, "--ros-args"].index("--ros-args")])
    with tempfile.TemporaryDirectory(prefix="install_") as prefix:
        _install(packages, here, Path(prefix))
        try:
            return launch_file(here / file, arguments, here, [{"use_sim_time": True}])
        except CommandError as refusal:
            text = ". ".join(line.strip().rstrip(".") for line in refusal.message.splitlines())
            raise RuntimeError(text.replace(f"{here}{os.sep}", "")) from None


def _install(packages: Mapping[str, UnbuiltPackage], here: Path, prefix: Path) -> None:
    """Make an install folder, and let programs find it as after `source install/setup.bash`."""
    index = prefix / "share" / "ament_index" / "resource_index" / "packages"
    index.mkdir(parents=True)
    for name, package in packages.items():
        (index / name).touch()
        (prefix / "share" / name).symlink_to(here / package.folder)
        scripts = prefix / "lib" / name
        scripts.mkdir(parents=True)
        for called, executable in package.executables.items():
            script = scripts / called
            script.write_text(_script(executable, here), encoding="utf-8")
            script.chmod(0o755)
    os.environ["AMENT_PREFIX_PATH"] = os.pathsep.join(filter(None, [f"{prefix}", os.environ.get("AMENT_PREFIX_PATH")]))
    folders = {f"{here / one.folder}": None for package in packages.values() for one in package.executables.values()}
    os.environ["PYTHONPATH"] = os.pathsep.join(filter(None, [*folders, os.environ.get("PYTHONPATH")]))


def _script(one: UnbuiltExecutable, here: Path) -> str:
    places = {"file": f"{here / one.file}", "folder": f"{here / one.folder}"}
    return _SCRIPT.format(python=sys.executable, module=one.module, function=one.function, **places)
