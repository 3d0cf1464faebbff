"""Has code checked in a process of its own, which never keeps the kernel longer than it may."""

from __future__ import annotations

import json
import os
import sys
import tempfile
from pathlib import Path

from spinbook.runtime.failure import CellFailed
from spinbook.runtime.process import KeptProcess

#: How long the process has to end in order when it is told to (s).
_GRACE = (0.5, 0.5)


def checked(exercise: Path, code: str, seconds: float) -> dict[str, str]:
    """The result for `code`, by media type: text/html and text/plain.

    Raises CellFailed when there is none: after `seconds`, when interrupted, or by a fault that is not the student's.
    """
    with tempfile.TemporaryDirectory(prefix="spinbook-") as temporary:
        folder = Path(temporary)
        (folder / "code").write_text(code, encoding="utf-8", errors="replace")
        argv = [sys.executable, "-m", "spinbook.check.program", os.fspath(exercise), "code", "result"]
        process = KeptProcess(argv, os.environ, folder)
        try:
            status = process.wait(seconds)
            if status.running:
                raise CellFailed(
                    f"The check was not done after {seconds:g} s and has been stopped. Does your program do something "
                    "for a long time before it spins its node? If not, this machine may be very busy: try again, or "
                    f"allow more time, as in %check {exercise.name} --seconds {2 * seconds:g}"
                )
            said = process.read_all()[0].decode(errors="replace")
        except KeyboardInterrupt:
            raise CellFailed("The check was interrupted; nothing is known of your code.") from None
        finally:
            if process.status.running:
                process.stop(_GRACE)
            process.close()
        return _result(folder / "result", said)


def _result(file: Path, said: str) -> dict[str, str]:
    try:
        result: dict[str, str] = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        last = "\n".join(said.strip().splitlines()[-3:])
        raise CellFailed(f"The check itself broke, which is not your fault:\n{last}") from None
    if "problem" in result:
        raise CellFailed(result["problem"])
    return result
