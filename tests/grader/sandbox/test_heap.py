"""After the gaps of the heap have been filled, what is new lies behind everything else."""

from __future__ import annotations

import ctypes
import subprocess
import sys

import pytest

from grader.sandbox import heap

PROGRAM = """
import ctypes, json, email, http.client, unittest
from grader.sandbox import heap

library = ctypes.CDLL(None)
library.malloc.restype = library.sbrk.restype = ctypes.c_void_p

def end():
    library.mallinfo2.restype = heap._Statistics
    return library.sbrk(ctypes.c_long(0)) - library.mallinfo2().keepcost

before = end()
{fill}
pieces = [library.malloc(ctypes.c_size_t(size)) for size in (24, 100, 500, 1000, 5000, 20000) for _ in range(20)]
print(sum(piece < before for piece in pieces))
"""


def pieces_in_gaps(fill: str) -> int:
    """Return how many of 120 new pieces of memory lie between those that were there before."""
    found = subprocess.run(
        [sys.executable, "-c", PROGRAM.format(fill=fill)], capture_output=True, text=True, check=True, timeout=60
    )
    return int(found.stdout)


@pytest.mark.skipif(sys.platform != "linux", reason="the C library of Linux has these statistics")
def test_what_is_new_lies_behind_what_was_there() -> None:
    # Python itself frees a few pieces after that.
    assert pieces_in_gaps("heap.fill_gaps()") < pieces_in_gaps("") / 5


def test_another_c_library_is_left_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    class Other:
        """A C library without mallinfo2, such as musl."""

    monkeypatch.setattr(ctypes, "CDLL", lambda name: Other())

    heap.fill_gaps()
