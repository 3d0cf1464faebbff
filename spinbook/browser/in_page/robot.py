"""`%robot` in a page: a terminal's process records as in a notebook, and the page's script draws meanwhile."""

from __future__ import annotations

import json
from typing import Any

from rclpy.context import Context

from ros_in_python.robot.description import description_text
from ros_in_python.robot.drawing import RobotMotion, as_data
from ros_in_python.robot.urdf import InvalidUrdf, read
from spinbook.browser.in_page.plot import record
from spinbook.kernel.robot_recorder import APPEAR_S, RobotRecorder, RobotRecording

#: How often new positions are sent to the page (s).
_PERIOD_S = 0.05


def show(page: Any, source: str, seconds: float) -> dict[str, Any]:
    """Send the page a robot's data and then its joints' positions, for this many seconds from the first one on.

    Return `problem`, "" if there is a robot, and `moves`, whether any positions arrived.
    """
    recording = _LiveRecording(page)
    try:
        if source:
            recording.note("description", description_text(source))
        record(recording, recording.recorder, seconds, APPEAR_S)
    except InvalidUrdf as error:
        recording.error = str(error)
    return {"problem": recording.problem, "moves": bool(recording.curves)}


class _LiveRecording(RobotRecording):
    """Passes what arrives on to the page."""

    def __init__(self, page: Any) -> None:
        super().__init__()
        self._page = page
        self._sent: dict[str, float] = {}

    def recorder(self, context: Context) -> RobotRecorder:
        """Return a recorder for this recording."""
        recorder = RobotRecorder(self.note, context)
        recorder.create_timer(_PERIOD_S, self._send)
        return recorder

    def note(self, kind: str, *values: Any) -> None:
        """Take one line of the recorder."""
        super().note(kind, *values)
        if kind == "description":
            self._page.picture(json.dumps({"robot": as_data(read(self.description), RobotMotion())}))

    def _send(self) -> None:
        positions = {name: values[-1] for name, (_, values) in self.positions().items()}
        if positions != self._sent:
            self._page.picture(json.dumps({"positions": positions}))
            self._sent = positions
