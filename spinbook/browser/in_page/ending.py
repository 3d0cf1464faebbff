"""How a program ends that is to go no further, as one that is killed: by an exception, since it shares the interpreter.

A program may catch every exception, as `except: pass` in a loop does. Then the exception is raised once more, within
that handler, whose own loop does not catch it.
"""

from __future__ import annotations

import sys
from types import FrameType
from typing import Any

from spinbook.browser.in_page.hub import Over


def end(again: bool) -> None:
    """Raise `Over`; `again` says that the program went on after the one before."""
    if again:
        _raise_at_next_line(sys._getframe(), getattr(sys.modules["__main__"], "__file__", ""))
    raise Over


def _raise_at_next_line(frame: FrameType | None, file: str) -> None:
    """Let each frame of the program's file raise where it goes on. What a trace function raises also ends tracing."""
    while frame is not None:
        if frame.f_code.co_filename == file:
            frame.f_trace = _raise
        frame = frame.f_back
    sys.settrace(lambda *_: None)


def _raise(frame: FrameType, event: str, given: Any) -> Any:
    if event == "exception":
        return _raise  # on its way to the handler
    raise Over
