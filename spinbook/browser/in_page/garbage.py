"""Garbage collection in a page whose threads have stacks of their own.

CPython 3.14 collects on its own in small steps, and each step reads the frames of every thread (`mark_stacks` in its
`Python/gc.c`). Part of these is on WebAssembly's argument stack. While a thread is suspended, Pyodide 314.0.7 moves
that part away and lets another thread write there. The collector then reads memory that is not a frame, and the
interpreter crashes: "memory access out of bounds", and `handback_tstate == NULL` when the next thread continues
(https://github.com/pyodide/pyodide/issues/6464). `gc.collect(0)` and `gc.collect(2)` read no frames. So nothing is
collected in steps while any thread is suspended, and a thread that is about to wait collects what is due.
"""

from __future__ import annotations

import gc
import itertools

#: New objects before a collection: CPython's own threshold.
_NEW = 2000
#: One in this many collections of new objects is a collection of all objects.
_FULL = 20
_collections = itertools.count(1)


def before_suspending() -> None:
    """Keep CPython from collecting in steps; collect what is due."""
    gc.disable()
    if gc.get_count()[0] > _NEW:
        gc.collect(2 if next(_collections) % _FULL == 0 else 0)


def after_resuming(suspended: int) -> None:
    """Let CPython collect again if no other stack is suspended."""
    if not suspended:
        gc.enable()
