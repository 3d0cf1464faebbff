"""What goes wrong in a cell that ends as if nothing were wrong: an exception in a thread, the exit code of `!…`, a
`%cd` into a folder that is not there.
"""

from __future__ import annotations

import re
import threading
import traceback
from typing import Any

from IPython.utils.capture import capture_output

from spinbook.kernel.node_errors import NodeError, how_it_ended

#: Python's name of a thread without one of its own has a number that changes from run to run: `Thread-5 (work)`.
_NUMBERED = re.compile(r"Thread-\d+(?: \((.+)\))?$")


class SilentErrors:
    """Keeps these errors until they are reported."""

    def __init__(self) -> None:
        self._errors: list[NodeError] = []

    def watch(self, shell: Any) -> None:
        """From now on, keep what goes wrong; `shell` is IPython's."""
        system, change_folder = shell.system, shell.find_line_magic("cd")

        def run(command: str) -> None:
            system(command)
            if code := shell.user_ns.get("_exit_code", 0):
                self._errors.append(NodeError(f"!{command.strip()}", f"It {how_it_ended(code)}"))

        def go(folder: str) -> Any:
            with capture_output() as said:
                result = change_folder(folder)
            said.show()
            if said.stdout.startswith("[Errno"):
                self._errors.append(NodeError(f"%cd {folder}", said.stdout.splitlines()[0].partition("] ")[2] + "."))
            return result

        shell.system = run
        shell.register_magic_function(go, magic_name="cd")

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
