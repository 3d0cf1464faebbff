"""Whether /dev/shm, through which Fast DDS talks within a machine by default, has room."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

from spinbook.doctor.finding import Finding, ok, warning

#: Each participant of Fast DDS takes about half a MB.
_ENOUGH = 32 * 2**20
_NOT_NEEDED = "Notebooks and the grader don't need it; nodes in your terminals print warnings without it."


def examine(name: str) -> Finding:
    """Write there, and look at how much is free."""
    place = Path("/dev/shm")
    try:
        with tempfile.TemporaryFile(dir=place) as file:
            file.write(b"spinbook")
    except OSError as error:
        return warning(name, f"{place} can't be written: {error.strerror}", _NOT_NEEDED)
    free = shutil.disk_usage(place).free
    left = sum(1 for _ in place.glob("fastrtps_*"))
    found = f"{place}, {free // 2**20} MB free" + (f", {left} files of Fast DDS" if left else "")
    if free < _ENOUGH:
        return warning(
            name,
            found,
            f"{_NOT_NEEDED}\nRemove what killed nodes have left (fastdds shm clean); in a container: --shm-size 256m",
        )
    return ok(name, found)
