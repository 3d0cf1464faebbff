"""What ends a thread of the notebook's own process: Python prints it, and the cell ends as if nothing were wrong."""

from __future__ import annotations

import re
import threading
import traceback
from typing import Any

from spinbook.kernel.node_errors import NodeError

#: Python's name of a thread without one of its own has a number that changes from run to run: `Thread-5 (work)`.
_NUMBERED = re.compile(r"Thread-\d+(?: \((.+)\))?$")


class ThreadErrors:
    """Keeps the exceptions that end threads until they are reported."""

    def __init__(self) -> None:
        self._errors: list[NodeError] = []

    def watch(self, shell: Any) -> None:
        """From now on, keep what ends a thread; `shell` is IPython's."""

        def keep(ended: threading.ExceptHookArgs) -> None:
            if ended.exc_value is not None and not isinstance(ended.exc_value, SystemExit):
                self._errors.append(_error(shell, ended))

        threading.excepthook = keep

    def taken(self) -> list[NodeError]:
        """Return what was kept since the last call."""
        errors, self._errors = self._errors, []
        return errors


def _error(shell: Any, ended: threading.ExceptHookArgs) -> NodeError:
    """Return the report, with the frames of cells only."""
    cells = [
        (f"Cell {cell[1]}", frame)
        for frame in traceback.extract_tb(ended.exc_traceback)
        if (cell := shell.compile.format_code_name(frame.filename))
    ]
    shown = [f"{cell}, line {frame.lineno}, in {frame.name}\n    {frame.line}" for cell, frame in cells]
    file, line = (cells[-1][0], cells[-1][1].lineno or 0) if cells else ("", 0)
    name = ended.thread.name if ended.thread else ""
    if numbered := _NUMBERED.match(name):
        name = numbered[1] or ""
    what = traceback.format_exception_only(ended.exc_value)[-1].strip().rstrip(".")
    return NodeError(f"thread {name}".strip(), f"{what}.", file, line, "\n".join(shown))
