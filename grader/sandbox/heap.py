"""Fills the gaps in the C library's heap, so that a fork allocates new memory in one place.

After many imports, free memory consists of small gaps between objects that stay. A fork that used them would write to
hundreds of pages that it shares with its parent, and the kernel would copy each of them: 3 µs per page.
"""

from __future__ import annotations

import contextlib
import ctypes

#: Larger pieces are not filled: there are few, and they are used up one after another anyway (bytes).
_LARGEST = 65536


class _Statistics(ctypes.Structure):
    """`struct mallinfo2` of glibc 2.33 and later, ten numbers: mallinfo(3)."""

    _fields_ = (("others", ctypes.c_size_t * 9), ("keepcost", ctypes.c_size_t))


def fill_gaps() -> None:
    """Allocate every free piece below the end of the heap, and never free it. Works with glibc only."""
    with contextlib.suppress(AttributeError):
        library = ctypes.CDLL(None)
        library.mallinfo2.restype = _Statistics
        library.sbrk.restype = library.malloc.restype = ctypes.c_void_p
        end = library.sbrk(ctypes.c_long(0)) - library.mallinfo2().keepcost
        size = _LARGEST
        while size >= 16:
            _take_all(library, size, end)
            size -= max(16, size // 4)


def _take_all(library: ctypes.CDLL, size: int, end: int) -> None:
    """Allocate pieces of `size` bytes until one is beyond the former end."""
    while (piece := library.malloc(ctypes.c_size_t(size))) and piece < end:
        pass
    library.free(ctypes.c_void_p(piece))
