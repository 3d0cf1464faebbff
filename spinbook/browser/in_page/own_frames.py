"""Tracebacks with the program's own frames only: those of libraries, and of what runs it here, help no student."""

from __future__ import annotations

import re
import sys
import traceback
from collections.abc import Iterator
from typing import TextIO

_LIBRARIES = ("/ros.zip/", "/check.zip/", "/share.zip/", "/lib/", "<frozen ")
_FRAME = re.compile(r'^( *)File "([^"\n]+)", line \d+.*\n(?:\1 +(?!File ").*\n)*', re.MULTILINE)


def _is_own(file: str) -> bool:
    return not file.startswith(_LIBRARIES)


def print_error(error: BaseException, output: TextIO | None = None) -> None:
    """Print an exception, and those that led to it, with the program's frames."""
    whole = traceback.TracebackException.from_exception(error)
    for part in _chain(whole):
        part.stack = traceback.StackSummary.from_list([frame for frame in part.stack if _is_own(frame.filename)])
    print("".join(whole.format()), end="", file=output or sys.stderr)


def _chain(part: traceback.TracebackException) -> Iterator[traceback.TracebackException]:
    yield part
    for other in (part.__cause__, part.__context__):
        if other is not None:
            yield from _chain(other)


def with_own_frames(log: str) -> str:
    """Return a log whose tracebacks have lost the frames of libraries."""
    return _FRAME.sub(lambda frame: frame[0] if _is_own(frame[2]) else "", log)
