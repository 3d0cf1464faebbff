"""Ends a program that did not catch an exception, as a Python interpreter does."""

from __future__ import annotations

import contextlib
import io
import os
import signal
import sys
import threading
from typing import NoReturn, TextIO

# Not empty when an uncaught KeyboardInterrupt ends the program.
_interrupted: list[bool] = []


def end(fault: BaseException) -> NoReturn:
    """Print an exception without the lines of the function that caught it, and exit with 1.

    After a KeyboardInterrupt `end_of_interrupt` ends the process by SIGINT.
    """
    trace = fault.__traceback__.tb_next if fault.__traceback__ is not None else None
    _interrupted.extend([True] if isinstance(fault, KeyboardInterrupt) else [])
    shown = fault.with_traceback(trace)
    if sys.excepthook is sys.__excepthook__ and sys.stderr is not None:
        _print_at_once(shown, sys.stderr)
    else:
        sys.excepthook(type(fault), shown, trace)
    sys.exit(1)


def end_of_interrupt() -> None:
    """End the process by SIGINT if it was interrupted: call this when everything else has ended."""
    if not _interrupted:
        return
    sys.stdout.flush()
    sys.stderr.flush()
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    os.kill(os.getpid(), signal.SIGINT)


class _OfOneThread(io.StringIO):
    """Keeps the text that the thread which created it writes, and passes on the text of other threads to `others`."""

    def __init__(self, others: TextIO) -> None:
        super().__init__()
        self._others, self._owner = others, threading.get_ident()

    def write(self, text: str) -> int:
        return super().write(text) if threading.get_ident() == self._owner else self._others.write(text)


def _print_at_once(fault: BaseException, output: TextIO) -> None:
    """Print an exception in one piece.

    The interpreter prints it line by line. Another thread may print a traceback of its own at that time, as rclpy's
    executor does for a goal in progress, and the lines of the two would be mixed.
    """
    kept = _OfOneThread(output)
    with contextlib.redirect_stderr(kept):
        sys.__excepthook__(type(fault), fault, fault.__traceback__)
    try:
        output.write(kept.getvalue())
        output.flush()
    except (OSError, ValueError):  # closed: leave it to the interpreter
        sys.__excepthook__(type(fault), fault, fault.__traceback__)
