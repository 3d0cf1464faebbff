"""`%plot`: records topics for a while and shows them; live where somebody watches, once where nobody does."""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path
from typing import Any

from IPython.display import display

from spinbook.kernel.environment import EXECUTING
from spinbook.kernel.plot.drawing import as_png, draw, in_words, moving_plot
from spinbook.kernel.plot.quantity import Recording
from spinbook.kernel.process import CellFailed, KeptProcess

#: How long a topic may take to appear (s).
_APPEAR_S = 5.0
#: How often a watched plot is drawn anew (s).
_REDRAW_S = 0.5


def run(paths: list[str], seconds: float, title: str) -> None:
    """Record these paths for so many seconds from the first sample on, and show the plot. Raises CellFailed."""
    argv = [sys.executable, "-u", "-m", "spinbook.kernel.plot.recorder", *paths]
    process = KeptProcess(argv, os.environ, Path.cwd())
    recording = Recording()
    try:
        handle = _record(process, recording, seconds, title)
    finally:
        process.stop((0.5, 0.5))
        process.close()
    if recording.error:
        raise CellFailed(recording.error)
    if not recording.curves:
        raise CellFailed(_nothing_received(recording, paths))
    _show(recording, title, handle)


def _record(process: KeptProcess, recording: Recording, seconds: float, title: str) -> Any:
    """Take in what comes. Returns the handle of the picture that is being watched, if one is."""
    watched = EXECUTING not in os.environ
    handle: Any = None
    rest = ""
    started = time.monotonic()
    first: float | None = None
    drawn = 0.0
    try:
        while True:
            data, _ = process.read()
            *lines, rest = (rest + data.decode(errors="replace")).split("\n")
            recording.take(lines)
            now = time.monotonic()
            if recording.error or not process.status.running:
                return handle
            if first is None and recording.curves:
                first = now
            if (first is None and now - started > _APPEAR_S + 2) or (first is not None and now - first > seconds):
                return handle
            if watched and first is not None and now - drawn > _REDRAW_S:
                handle = _show(recording, title, handle)
                drawn = now
            time.sleep(0.03)
    except KeyboardInterrupt:
        return handle


def _show(recording: Recording, title: str, handle: Any) -> Any:
    """Show what has been recorded so far. Where nobody has watched it come, it comes again, as a moving picture."""
    words = in_words(recording)
    bundle = {"image/png": as_png(draw(recording, title)), "text/plain": words}
    if EXECUTING in os.environ and (moving := moving_plot(recording, title)) is not None:
        bundle["image/svg+xml"] = moving
    metadata = {kind: {"alt": words} for kind in bundle if kind != "text/plain"}
    if handle is None:
        return display(bundle, raw=True, metadata=metadata, display_id=True)
    handle.update(bundle, raw=True, metadata=metadata)
    return handle


def _nothing_received(recording: Recording, paths: list[str]) -> str:
    there = ", ".join(recording.published) or "none"
    if recording.waiting:
        return f"Nobody publishes {', '.join(recording.waiting)}. Topics with a publisher are: {there}."
    return f"{', '.join(paths)}: there is a publisher, but no message arrived."
