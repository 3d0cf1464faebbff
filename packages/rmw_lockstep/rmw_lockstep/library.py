"""Finds the compiled middleware, and the environment in which a process loads it."""

from __future__ import annotations

import hashlib
import importlib.util
import json
import os
import platform
import shlex
import shutil
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from rmw_lockstep import IDENTIFIER
from rmw_lockstep.ros import Ros, installed_ros

#: The folder with the C++ sources.
SOURCES = Path(__file__).parent

#: The package in which a prebuilt wheel contains the libraries.
PREBUILT = "rmw_lockstep_prebuilt"

#: Describes what a folder of libraries was made from.
DESCRIPTION = "built.json"


@dataclass(frozen=True)
class Library:
    """The compiled middleware.

    `folder` contains `liblockstep.so`, `librmw_lockstep_cpp.so` and the folder `wheels/`. `prefix` is the ROS 2 that
    it is for.
    """

    folder: Path
    prefix: Path

    @property
    def preload(self) -> Path:
        """What is preloaded: the connection to the hub, simulated time and idle detection."""
        return self.folder / "liblockstep.so"

    @property
    def search_folder(self) -> Path:
        """The first entry of `LD_LIBRARY_PATH`.

        PyPI's wheels are linked to librmw_fastrtps_cpp.so by name, so for them a library of this name comes first. Any
        other ROS 2 loads the library that `RMW_IMPLEMENTATION` names.
        """
        return self.folder if Ros(self.prefix).chooses_at_run_time else self.folder / "wheels"

    def environment(self, of: Mapping[str, str]) -> dict[str, str]:
        """Return the variables that make a process load this middleware; `of` are those it would have otherwise.

        With PyPI's wheels `RMW_IMPLEMENTATION` chooses nothing. But rcl compares it with the middleware that was
        loaded, and ends the process with exit code 102 if they differ.
        """
        preload, folders = str(self.preload), [str(self.search_folder)]
        if " " in preload:  # which separates the entries of LD_PRELOAD, and not those of LD_LIBRARY_PATH
            preload, folders = self.preload.name, [*folders, str(self.folder)]
        return {
            "LD_PRELOAD": preload,
            "LD_LIBRARY_PATH": os.pathsep.join(filter(None, (*folders, of.get("LD_LIBRARY_PATH")))),
            "RMW_IMPLEMENTATION": IDENTIFIER,
        }


@dataclass(frozen=True)
class UnavailableLibrary:
    """Why there is no compiled middleware, and what to do about it."""

    reason: str
    remedy: str


def library() -> Library | UnavailableLibrary:
    """Return the compiled middleware for the ROS 2 in use, or why there is none. Never compiles: see `build.build`."""
    ros = installed_ros()
    if ros is None:
        return UnavailableLibrary("ROS 2's headers are not installed here", "Install ROS 2: make setup")
    if not sources():
        return UnavailableLibrary(f"its C++ sources are not in {SOURCES}", "Install the package again.")
    for folder in _folders(ros):
        if (folder / DESCRIPTION).exists():
            return Library(folder, ros.prefix)
    built_by_colcon = _built_by_colcon() if ros.chooses_at_run_time else None
    if built_by_colcon:
        return Library(built_by_colcon, ros.prefix)
    if ros.lacks_middleware:
        reason = "its wheel is not installed, and without Fast DDS it can't be compiled"
        return UnavailableLibrary(reason, f"Install the wheel {PREBUILT} of the release: docs/installing.md.")
    if compiler() is None:
        reason = "neither a wheel of it that fits is installed, nor g++ to compile it"
        return UnavailableLibrary(reason, f"Install one of them: the wheel {PREBUILT}, or sudo apt-get install g++")
    return UnavailableLibrary("it has not been compiled for this ROS 2", "Compile it: python -m rmw_lockstep.build")


def _folders(ros: Ros) -> Iterator[Path]:
    if compiler():
        name = key(ros)
        yield from (root / name for root in library_folders())
    else:  # for example in a container image that was made smaller after set-up
        compiled = (folder for root in library_folders() if root.is_dir() for folder in sorted(root.iterdir()))
        yield from (folder for folder in compiled if _fits(folder, ros))
    if (prebuilt := _prebuilt()) and _fits(prebuilt, ros):
        yield prebuilt


def library_folders() -> Iterator[Path]:
    """Yield the folders for compiled libraries, each set named by its key: the first writable one is used."""
    yield Path(sys.prefix) / "lib/rmw_lockstep"
    if cache_home := os.environ.get("XDG_CACHE_HOME"):
        yield Path(cache_home) / "rmw_lockstep"
    elif home := os.environ.get("HOME"):
        yield Path(home) / ".cache/rmw_lockstep"


def sources() -> list[Path]:
    """Return every C++ file, in a fixed order."""
    found = (SOURCES / folder for folder in ("lockstep", "src"))
    return sorted(
        file for folder in found for file in folder.rglob("*") if file.suffix in (".cpp", ".hpp", ".h", ".map")
    )


@cache
def sources_digest() -> str:
    """Return the SHA-256 of the C++ sources and of how they are compiled."""
    total = hashlib.sha256()
    for file in (*sources(), SOURCES / "build.py", SOURCES / "ros.py"):
        content = file.read_bytes()
        total.update(f"{file.relative_to(SOURCES)} {len(content)}\n".encode())
        total.update(content)
    return total.hexdigest()


def compiler() -> list[str] | None:
    """Return the C++ compiler, `CXX` or otherwise g++, as the beginning of a command line; None if not installed."""
    command = shlex.split(os.environ.get("CXX", "")) or ["g++"]
    return command if shutil.which(command[0]) else None


def key(ros: Ros) -> str:
    """Return the key of the libraries that this machine would compile: a digest of sources, compiler, CPU and ROS 2."""
    command = compiler()
    described: list[object] = [sources_digest(), description(ros), command]
    if command:
        program = Path(shutil.which(command[0]) or command[0]).resolve()
        described += [program.name, program.stat().st_size, program.stat().st_mtime_ns]
    return hashlib.sha256(json.dumps(described, sort_keys=True).encode()).hexdigest()[:16]


def description(ros: Ros) -> dict[str, object]:
    """Return what decides whether libraries that were compiled elsewhere fit here."""
    return {"sources": sources_digest(), "machine": platform.machine(), "ros": dict(ros.versions)}


def _built_by_colcon() -> Path | None:
    """Return the lib/ of a sourced workspace into which the CMakeLists.txt in this folder installed the libraries."""
    for prefix in filter(None, os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)):
        if Path(prefix, "share", IDENTIFIER, "package.xml").exists():
            return Path(prefix, "lib")
    return None


def _prebuilt() -> Path | None:
    """Return the folder of an installed prebuilt wheel."""
    found = importlib.util.find_spec(PREBUILT)
    return Path(found.origin).parent if found and found.origin else None


def _fits(folder: Path, ros: Ros) -> bool:
    """Return whether prebuilt libraries fit these sources, this CPU and these versions of ROS 2 (except patches)."""
    try:
        built = json.loads((folder / DESCRIPTION).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return False
    return bool(_comparable(built) == _comparable(description(ros)))


def _comparable(built: Mapping[str, object]) -> dict[str, object]:
    versions = built.get("ros")
    assert isinstance(versions, Mapping)
    return {**built, "ros": {name: str(version).split(".")[:2] for name, version in versions.items()}}
