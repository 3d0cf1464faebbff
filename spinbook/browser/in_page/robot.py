"""`%robot` in a page: listens as in a notebook, and lets the page's script draw."""

from __future__ import annotations

import json
import time
from typing import Any

#: How often new positions are sent to the page (s), and how long nobody may publish any before it ends (s).
_PERIOD_S, _SILENT_S = 0.05, 15.0


def show(page: Any, source: str) -> None:
    """Send the page a robot's data and then its joints' positions, until interrupted or nobody publishes any more."""
    import rclpy

    from ros_in_python.robot.urdf import InvalidUrdf

    rclpy.init(args=[])
    try:
        _listen(_Sender(page, source))
    except (InvalidUrdf, LookupError, ValueError) as error:
        page.picture(json.dumps({"problem": str(error.args[0] if error.args else error)}))
    finally:
        rclpy.try_shutdown()


class _Sender:
    """Passes what a `RobotRecorder` records to the page."""

    def __init__(self, page: Any, source: str) -> None:
        from ros_in_python.robot.description import description_text

        self._page = page
        self._positions: dict[str, float] = {}
        self._topic = ""
        if source:
            self.note("description", description_text(source))

    def note(self, kind: str, *values: Any) -> None:
        """Take one line of the recorder. What joints do counts more than what they are told to do."""
        from ros_in_python.robot.drawing import RobotMotion, as_data
        from ros_in_python.robot.urdf import read
        from spinbook.kernel.robot_recorder import TOPICS

        if kind == "description":
            self._page.picture(json.dumps({"robot": as_data(read(values[0]), RobotMotion())}))
        elif kind == "sample" and (not self._topic or TOPICS.index(values[0]) <= TOPICS.index(self._topic)):
            self._topic, self._positions[values[3]] = values[0], values[5]

    def send(self) -> None:
        """Send the positions that are new."""
        if self._positions:
            self._page.picture(json.dumps({"positions": self._positions}))
            self._positions = {}


def _listen(sender: _Sender) -> None:
    import rclpy
    from rclpy.executors import SingleThreadedExecutor

    from spinbook.kernel.robot_recorder import RobotRecorder

    executor, recorder = SingleThreadedExecutor(), RobotRecorder(sender.note)
    executor.add_node(recorder)
    recorder.create_timer(_PERIOD_S, sender.send)
    heard = time.monotonic()
    while rclpy.ok() and time.monotonic() - heard < _SILENT_S:
        executor.spin_once(timeout_sec=_PERIOD_S)
        if recorder.has_publishers():
            heard = time.monotonic()
