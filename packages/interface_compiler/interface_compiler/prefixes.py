"""Where ROS packages are installed: ament prefixes, and the packages and interfaces found in their index."""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Iterable
from pathlib import Path

RESOURCES = Path("share", "ament_index", "resource_index")
#: Where a prefix keeps its Python packages.
PYTHON = Path("lib", f"python{sys.version_info.major}.{sys.version_info.minor}", "site-packages")

#: The file in a package's share folder with the key of what it was compiled from.
KEY = "compiler-key"


def installed() -> list[Path]:
    """Return the prefixes of AMENT_PREFIX_PATH, then this Python's own (the wheels'), once each, in that order."""
    named = [Path(entry) for entry in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if entry]
    own = Path(sys.prefix)
    found = [prefix for prefix in [*named, own] if (prefix / RESOURCES).is_dir()]
    return list(dict.fromkeys(found))


def packages(prefixes: Iterable[Path]) -> dict[str, Path]:
    """Return package -> its prefix; the first prefix that has it wins."""
    markers = resources("packages", prefixes)
    return {name: marker.parents[len(RESOURCES.parts) + 1] for name, marker in markers.items()}


def prefix_of(package: str, prefixes: Iterable[Path]) -> Path | None:
    """Return the first prefix that has `package`."""
    for prefix in prefixes:
        if (prefix / RESOURCES / "packages" / package).is_file():
            return prefix
    return None


def resources(kind: str, prefixes: Iterable[Path]) -> dict[str, Path]:
    """Return name -> marker file of every resource of a `kind`, such as `rosidl_interfaces` or `rmw_typesupport`."""
    found: dict[str, Path] = {}
    for prefix in prefixes:
        for marker in sorted(_markers(prefix, kind)):
            found.setdefault(marker.name, marker)
    return found


def interfaces(prefixes: Iterable[Path]) -> dict[str, frozenset[str]]:
    """Return package -> its interfaces as `msg/String`, for every package in these prefixes that has any."""
    return {package: _listed(marker) for package, marker in resources("rosidl_interfaces", prefixes).items()}


def interfaces_of(package: str, prefixes: Iterable[Path]) -> frozenset[str]:
    """Return one package's interfaces as `msg/String`, from the first prefix that has any; empty if none has."""
    markers = (prefix / RESOURCES / "rosidl_interfaces" / package for prefix in prefixes)
    return next((_listed(marker) for marker in markers if marker.is_file()), frozenset())


def definitions_of(package: str, prefix: Path) -> dict[str, str]:
    """Return path such as `msg/String.msg` -> text, for the definitions that an installed package keeps."""
    share = prefix / "share" / package
    files = (file for kind in ("msg", "srv", "action") for file in sorted(share.glob(f"{kind}/*.{kind}")))
    return {file.relative_to(share).as_posix(): file.read_text(encoding="utf-8") for file in files}


def key_of(package: str, prefix: Path) -> str:
    """Return the key of a package that was compiled into a prefix, or of an installed one; empty if CMake made it."""
    with contextlib.suppress(OSError):
        return (prefix / "share" / package / KEY).read_text(encoding="utf-8")
    return ""


def _listed(marker: Path) -> frozenset[str]:
    names = (line.strip().rpartition(".") for line in marker.read_text(encoding="utf-8").splitlines())
    endings = ("msg", "srv", "action", "idl")
    return frozenset(stem for stem, _, ending in names if ending in endings and stem.split("/")[0] in endings[:3])


def _markers(prefix: Path, kind: str) -> list[Path]:
    folder = prefix / RESOURCES / kind
    if not folder.is_dir():
        return []
    return [marker for marker in folder.iterdir() if marker.is_file() and not marker.name.startswith(".")]
