"""Makes ROS 2's wheels usable in the Python that has just installed them.

A Python finds the wheels' libraries because the wheels start it a second time with LD_LIBRARY_PATH set. A kernel that
has installed them while it ran can't be started again without losing its notebook, so the libraries are loaded here.
"""

from __future__ import annotations

import ctypes
import os
from importlib.metadata import distributions
from pathlib import Path


def load_fresh_wheels() -> None:
    """Load the libraries of the ROS wheels into this process, and let the processes that it starts find them."""
    libraries = _libraries()
    left = list(libraries)
    while left:
        # One library may need another: whatever could not be loaded yet gets another turn.
        waiting = [library for library in left if not _loaded(library)]
        if len(waiting) == len(left):
            break
        left = waiting
    folders = dict.fromkeys(str(library.parent) for library in libraries)
    before = [entry for entry in os.environ.get("LD_LIBRARY_PATH", "").split(os.pathsep) if entry]
    os.environ["LD_LIBRARY_PATH"] = os.pathsep.join([*folders, *(entry for entry in before if entry not in folders)])


def _libraries() -> list[Path]:
    """Return the wheels' shared libraries, of several copies the first: some abort when they are loaded twice."""
    first: dict[str, Path] = {}
    for distribution in distributions():
        if not distribution.name.lower().startswith(("ros-", "ros_", "rosidl_", "rosgraph_", "rmw_")):
            continue
        for file in distribution.files or ():
            if ".so" in file.suffixes and not file.parent.name.isidentifier():
                place = Path(str(distribution.locate_file(file))).resolve()
                if place.parent.name == "lib" or place.parent.suffix == ".libs":
                    first.setdefault(place.name, place)
    return [first[name] for name in sorted(first)]


def _loaded(library: Path) -> bool:
    try:
        # Local, not global: with global symbols, Fast DDS frees memory twice at the end.
        ctypes.CDLL(str(library), mode=ctypes.RTLD_LOCAL)
    except OSError:
        return False
    return True
