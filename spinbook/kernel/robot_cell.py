"""`%robot`: a robot as its URDF describes it, moved by the positions of joints that arrive."""

from __future__ import annotations

import base64
import json
from html import escape
from importlib.resources import files
from typing import Any

import numpy as np

from ros_in_python.robot.description import description_text
from ros_in_python.robot.drawing import KIND, RobotMotion, as_data, in_words
from ros_in_python.robot.still import WIDTH, as_png
from ros_in_python.robot.urdf import InvalidUrdf, read
from spinbook.kernel.picture_cells import record, show_picture
from spinbook.kernel.robot_recorder import APPEAR_S, RobotRecording
from spinbook.package.cell_line import CellFailed

#: How many positions of a joint per second are kept (Hz), and for how long a picture moves at most (s).
_RATE, _LONGEST_S = 20.0, 20.0


def show_robot(source: str, seconds: float) -> None:
    """Record for this many seconds from the first position on, and show the robot. Raises CellFailed.

    `source` is a file or a package with a URDF; "" for the one that is published.
    """
    try:
        recording = RobotRecording(description=description_text(source)) if source else RobotRecording()
        handle = record("spinbook.kernel.robot_recorder", [], recording, seconds, _show_live, APPEAR_S)
        if recording.problem:
            raise CellFailed(recording.problem)
        _show(recording, handle)
    except InvalidUrdf as error:
        raise CellFailed(str(error)) from None


def _show_live(recording: RobotRecording, handle: Any) -> Any:
    if not recording.description:
        return handle
    robot, positions = read(recording.description), motion_of(recording).last
    picture = {"image/png": as_png(robot, positions, scale=1)}
    return show_picture(picture, in_words(robot, positions), handle, width=WIDTH)


def _show(recording: RobotRecording, handle: Any) -> None:
    robot, motion = read(recording.description), motion_of(recording)
    picture, data = as_png(robot, motion.last), as_data(robot, motion)
    pictures = {"image/png": picture, "text/html": _player(picture, data), KIND: data}
    show_picture(pictures, in_words(robot, motion.last), handle, width=WIDTH)


def motion_of(recording: RobotRecording) -> RobotMotion:
    """Return the recorded motion, every joint at the same times, at most 20 of them per second."""
    curves = recording.positions()
    if not curves:
        return RobotMotion()
    start = min(times[0] for times, _ in curves.values())
    end = min(max(times[-1] for times, _ in curves.values()), start + _LONGEST_S)
    most = max(sum(time <= end for time in times) for times, _ in curves.values())
    shared = np.linspace(start, end, max(2, min(most, round((end - start) * _RATE) + 1)))
    positions = {name: tuple(np.interp(shared, *curve).tolist()) for name, curve in curves.items()}
    return RobotMotion(tuple((shared - start).tolist()), positions)


def _player(picture: bytes, data: dict[str, Any]) -> str:
    """Return HTML that shows the picture, and moves it where a notebook allows scripts."""
    script = files("ros_in_python.robot").joinpath("robot_view.js").read_text(encoding="utf-8")
    still = f"data:image/png;base64,{base64.b64encode(picture).decode()}"
    style = ".is-live > img { display: none } .is-beyond { color: #d33a2c }"
    return (
        f'<style>{style}</style><div style="max-width: {WIDTH}px">'
        f'<img src="{still}" alt="{escape(data["words"])}" width="{WIDTH}"></div>'
        f"<script>{script}showRobot(document.currentScript.previousElementSibling, {as_script(data)})</script>"
    )


def as_script(data: dict[str, Any]) -> str:
    """Return data as JSON that may be in a script element."""
    return json.dumps(data, separators=(",", ":")).replace("<", "\\u003c")
