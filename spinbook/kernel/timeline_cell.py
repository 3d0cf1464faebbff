"""`%timeline`: records what happens on services, actions and topics while other cells run, and draws it."""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path

from spinbook.kernel.picture_cells import show_picture
from spinbook.kernel.process import KeptProcess
from spinbook.kernel.timeline import RecordedEvents, in_words, lanes
from spinbook.kernel.timeline_picture import span_of, timeline_svg
from spinbook.package.cell_line import CellFailed

#: How long the recorder may take to find the first name (s).
_APPEAR_S = 20.0
#: The time that messages sent just before the end may take to arrive (s).
_LATE_S = 0.3
#: The time that the recorder has to read what has arrived, and then to end after SIGTERM (s).
_STOP_GRACE = (10.0, 1.0)


class TimelineProcess:
    """A recorder that runs while other cells run. `names` are those of services, actions and topics."""

    def __init__(self, names: list[str]) -> None:
        argv = [sys.executable, "-u", "-m", "spinbook.kernel.timeline_recorder", *names]
        self.names = names
        self._process = KeptProcess(argv, os.environ, Path.cwd())
        self._happenings = RecordedEvents()

    def wait_for_all(self) -> list[str]:
        """Wait until every name has been found. Return those that were not. Raises CellFailed if it fails."""
        deadline = time.monotonic() + _APPEAR_S
        while self._missing() and time.monotonic() < deadline and self._process.status.running:
            time.sleep(0.03)
            self._read()
        if self._happenings.error or not self._process.status.running:
            self.close()
            raise CellFailed(self._happenings.error or "The timeline's recorder has ended. Run this cell again.")
        return self._missing()

    def _missing(self) -> list[str]:
        return [name for name in self.names if name not in self._happenings.kinds]

    def _read(self) -> None:
        self._happenings.take(self._process.read_lines())

    def end(self) -> RecordedEvents:
        """Stop recording. Return what has happened, in the order of the names."""
        time.sleep(_LATE_S)
        self._process.stop(_STOP_GRACE)
        self._process.wait(sum(_STOP_GRACE) + 1.0)
        self._read()
        self.close()
        kinds = self._happenings.kinds
        self._happenings.kinds = {name: kinds[name] for name in self.names if name in kinds}
        return self._happenings

    def close(self) -> None:
        """End the recorder."""
        self._process.close()


def begin(names: list[str]) -> TimelineProcess:
    """Start recording, and say so. Raises CellFailed if it fails."""
    timeline = TimelineProcess(names)
    try:
        missing = timeline.wait_for_all()
    except KeyboardInterrupt:
        timeline.close()
        raise
    print(f"Recording {', '.join(names)}. %timeline draws what happens from now on.")
    if missing:
        print(f"Not found yet: {', '.join(missing)}.")
    return timeline


def show(timeline: TimelineProcess, title: str) -> None:
    """Stop recording and draw what has happened. Raises CellFailed if nothing has."""
    happenings = timeline.end()
    if happenings.error:
        raise CellFailed(happenings.error)
    drawn = lanes(happenings)
    if not any(lane.marks for lane in drawn):
        raise CellFailed(f"Nothing has happened on {', '.join(timeline.names)} since `%timeline --record`.")
    show_picture({"image/svg+xml": timeline_svg(drawn, title)}, in_words(drawn, span_of(drawn)[0]))
