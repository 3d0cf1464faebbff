"""The ROS 2 that the middleware is compiled for: PyPI's wheels in this environment, or a sourced one."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

#: The packages whose headers the middleware includes. Each has its own folder in include/.
HEADERS = (
    *("rmw", "rcutils", "rcpputils", "fastcdr"),
    *("rosidl_runtime_c", "rosidl_runtime_cpp", "rosidl_typesupport_interface", "rosidl_dynamic_typesupport"),
    *("rosidl_typesupport_fastrtps_c", "rosidl_typesupport_fastrtps_cpp"),
)

#: What the middleware is linked with.
LIBRARIES = (
    *("rmw", "rcutils", "rcpputils", "fastcdr"),
    *("rosidl_runtime_c", "rosidl_typesupport_fastrtps_c", "rosidl_typesupport_fastrtps_cpp"),
)

#: The libraries of Fast DDS alone: its RMW, itself, and what it needs. In the wheels' lib/, and next to their packages.
_FAST_DDS = ("librmw_fastrtps_shared_cpp.so", "librmw_dds_common*.so", "libfastrtps.so.*")
_NEEDED_BY_FAST_DDS = ("libtinyxml2-*", "libssl-*", "libcrypto-*")

_PACKAGE_VERSION = re.compile(r"<version>\s*([^<\s]+)\s*</version>")
_FAST_CDR_VERSION = re.compile(r'FASTCDR_VERSION_STR\s+"([^"]+)"')


@dataclass(frozen=True)
class Ros:
    """An installed ROS 2; `prefix` is the folder with its include/, lib/ and share/."""

    prefix: Path

    @property
    def chooses_at_run_time(self) -> bool:
        """Whether `RMW_IMPLEMENTATION` chooses the middleware. PyPI's libraries are linked to Fast DDS by name."""
        return (self.prefix / "lib/librmw_implementation.so").exists()

    @property
    def versions(self) -> Mapping[str, str]:
        """The versions of everything that decides whether a compiled middleware fits: the API's, and Fast CDR's."""
        found = {name: _version(self.prefix / "share" / name / "package.xml", _PACKAGE_VERSION) for name in _DECISIVE}
        return found | {"fastcdr": _version(self.prefix / "include/fastcdr/config.h", _FAST_CDR_VERSION)}

    @property
    def include_folders(self) -> tuple[Path, ...]:
        """Where the compiler looks for headers."""
        top = self.prefix / "include"
        return (*(top / name for name in HEADERS if (top / name).is_dir()), top)

    @property
    def libraries(self) -> tuple[Path, ...]:
        """The libraries to link."""
        return tuple(self.prefix / "lib" / f"lib{name}.so" for name in LIBRARIES)

    @property
    def lacks_middleware(self) -> bool:
        """Whether the Fast DDS is missing that PyPI's libraries are linked to, as where programs are only graded."""
        return not self.chooses_at_run_time and not (self.prefix / "lib/librmw_fastrtps_cpp.so").exists()

    @property
    def unused_libraries(self) -> tuple[str, ...]:
        """The names of the libraries that PyPI's wheels are linked to but never call: those of Fast DDS."""
        if self.chooses_at_run_time:
            return ()
        beside = self.prefix.glob("lib/python3*/site-packages/ros_fastrtps.libs")
        places = {self.prefix / "lib": _FAST_DDS, **dict.fromkeys(beside, _NEEDED_BY_FAST_DDS)}
        found = (file for folder, patterns in places.items() for one in patterns for file in folder.glob(one))
        return tuple(sorted({file.name for file in found}))


_DECISIVE = ("rmw", "rcutils", "rosidl_runtime_c", "rosidl_typesupport_fastrtps_c")


def installed_ros() -> Ros | None:
    """Return the ROS 2 that this Python imports, or None. It must have its headers.

    A sourced ROS 2 comes first, as in Python's own search: its packages are on `PYTHONPATH`.
    """
    return next((Ros(prefix) for prefix in _prefixes() if (prefix / "include/rmw/rmw/rmw.h").exists()), None)


def _prefixes() -> Iterator[Path]:
    imported = [Path(entry) for entry in _entries("PYTHONPATH")]
    for prefix in map(Path, _entries("AMENT_PREFIX_PATH")):
        if any(entry.is_relative_to(prefix) for entry in imported):
            yield prefix
    yield Path(sys.prefix)


def _entries(variable: str) -> list[str]:
    return [entry for entry in os.environ.get(variable, "").split(os.pathsep) if entry]


def _version(file: Path, pattern: re.Pattern[str]) -> str:
    try:
        found = pattern.search(file.read_text(encoding="utf-8", errors="replace"))
    except OSError:
        return "unknown"
    return found[1] if found else "unknown"
