"""Makes a reproducible wheel of a compiled package, for Python 3.10 and later, and installs one."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Sequence
from importlib import metadata
from pathlib import Path

from interface_compiler import prefixes, shipped, store
from interface_compiler.checks import dependencies
from interface_compiler.definition import CompileError
from interface_compiler.prefixes import PYTHON, RESOURCES
from interface_compiler.wheel_file import wheel_file

_VERSION = "0.1.0"
#: Python 3.10 and later, as limited_api.h allows nothing else.
_PYTHONS = "cp310-abi3"


def wheel(package: str, prefix: Path) -> tuple[str, bytes]:
    """Return the file name and content of the wheel with one package of a prefix.

    Its version ends in the package's key, so that pip replaces one that was made from other definitions.
    """
    version = f"{_VERSION}+{prefixes.key_of(package, prefix)}"
    summary = f"The ROS 2 interfaces of {package}, compiled by interface_compiler"
    return wheel_file(_project(package), version, summary, _PYTHONS, _python(package, prefix), _data(package, prefix))


def install(package: str) -> bool:
    """Compile and install a package that comes with this package. Return False if it is there already.

    Raises KeyError for any other package, and CompileError if it can't be compiled or installed.
    """
    definitions = shipped.definitions(package)
    if is_current(package):
        return False
    with tempfile.TemporaryDirectory(prefix="interfaces-") as temporary:
        compiled = store.ensure(definitions, Path(temporary))
        name, content = wheel(package, compiled.prefix)
        file = Path(temporary) / name
        file.write_bytes(content)
        _pip_install([file])
    return True


def needed(package: str) -> list[str]:
    """Return the packages that a shipped package needs, each after those that it needs itself."""
    found: list[str] = []
    for name in sorted(dependencies(shipped.definitions(package))[package]):
        if name in shipped.known():
            found += [each for each in (*needed(name), name) if each not in found]
    return found


def is_current(package: str) -> bool:
    """Return whether this environment has the wheel of exactly these definitions, made by exactly this compiler."""
    definitions = shipped.definitions(package)
    try:
        version = metadata.version(_project(package))
    except metadata.PackageNotFoundError:
        return False
    return version == f"{_VERSION}+{store.keys(definitions)[package]}"


def _project(package: str) -> str:
    return f"compiled-interfaces-{package.replace('_', '-')}"


def _python(package: str, prefix: Path) -> dict[str, bytes]:
    files = (file for file in _below(prefix / PYTHON / package) if "__pycache__" not in file.parts)
    return {file.relative_to(prefix / PYTHON).as_posix(): file.read_bytes() for file in files}


def _data(package: str, prefix: Path) -> dict[str, bytes]:
    """Return the files for the environment's share and include."""
    markers = sorted((prefix / RESOURCES).glob(f"*/{package}"))
    files = (*_below(prefix / "share" / package), *_below(prefix / "include" / package), *markers)
    return {file.relative_to(prefix).as_posix(): file.read_bytes() for file in files}


def _below(folder: Path) -> list[Path]:
    return sorted(file for file in folder.rglob("*") if file.is_file())


def _pip_install(files: Sequence[Path]) -> None:
    options = ["--quiet", "--disable-pip-version-check", "--no-deps", "--no-index"]
    command = [sys.executable, "-m", "pip", "install", *options, *map(str, files)]
    done = subprocess.run(command, capture_output=True, text=True, errors="replace", check=False)
    if done.returncode:
        error = (done.stderr.strip().splitlines() or [f"pip ended with exit code {done.returncode}"])[-1]
        raise CompileError(f"The compiled package could not be installed with pip: {error}")
