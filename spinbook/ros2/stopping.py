"""Being stopped from outside: Ctrl-C, or a notebook that ends a bounded command."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType
from typing import NoReturn

#: What the real command exits with after Ctrl-C (it passes on the number of the signal).
EXIT_AFTER_SIGINT = int(signal.SIGINT)


class Stopped(KeyboardInterrupt):
    """Raised in the main thread when SIGINT or SIGTERM came."""

    def __init__(self, number: int) -> None:
        super().__init__()
        #: Exit status: 2 after SIGINT as the real command's, 0 after SIGTERM.
        self.exit_code = EXIT_AFTER_SIGINT if number == signal.SIGINT else 0


def listen() -> None:
    """Make SIGINT and SIGTERM raise `Stopped`, for the rest of this process's life.

    SIGINT is set even where it was ignored (a shell ignores it for what it starts in the background), because a
    notebook stops its commands with it. Only the first signal is raised: cleaning up is not interrupted by the
    second, and a SIGTERM during it ends the process at once.
    """
    if threading.current_thread() is not threading.main_thread():
        return
    signal.signal(signal.SIGINT, _stop)
    signal.signal(signal.SIGTERM, _stop)


@contextmanager
def held_back() -> Iterator[None]:
    """Let the first signal that comes meanwhile raise `Stopped` only at the end of the block; a second ends it at once.

    For work inside rclpy: raised while its C++ makes a message, an exception comes out as a TypeError or not at all.
    """
    _held.append(None)
    try:
        yield
    finally:
        number = _held.pop()
    if number is not None:
        _raise(number)


# For each block that holds signals back, the number of the one that has come.
_held: list[int | None] = []


def _stop(number: int, frame: FrameType | None) -> None:
    if _held and _held[-1] is None:
        _held[-1] = number
    else:
        _raise(number)


def _raise(number: int) -> NoReturn:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    raise Stopped(number)
