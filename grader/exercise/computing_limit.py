"""The limit of what an author's code may compute, which names the line of an endless loop."""

from __future__ import annotations

import contextlib
import signal
import sys
import threading
from collections.abc import Iterator
from typing import NoReturn

#: How long an author's file, or one check, may compute (s). They take milliseconds.
LONGEST_CPU_S = 10.0


@contextlib.contextmanager
def computing_limit() -> Iterator[None]:
    """Raise TimeoutError in the line at which Python is, when the block has computed for `LONGEST_CPU_S`.

    Signals reach only the main thread of a process, and none in a page, which can be closed.
    """
    if sys.platform == "emscripten" or threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGVTALRM, _too_long)
    signal.setitimer(signal.ITIMER_VIRTUAL, LONGEST_CPU_S)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
        signal.signal(signal.SIGVTALRM, before)


def _too_long(number: int, frame: object) -> NoReturn:
    raise TimeoutError(f"it computed for {LONGEST_CPU_S:g} s: is there an endless loop?")
