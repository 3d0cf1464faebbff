"""`%plot` in a page: the process of plain cells records and draws, as the notebook does."""

from __future__ import annotations

import json
import time
from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from spinbook.kernel.plot.recording import PlotRecording


def plot(paths: Sequence[str], seconds: float, title: str) -> str:
    """Record these paths for this many seconds from the first sample on.

    Return the picture as JSON: `picture`, `words` and `problem`, "" if there is none.
    """
    from spinbook.kernel.plot.picture import in_words, plot_svg
    from spinbook.kernel.plot.recording import PlotRecording

    recording = PlotRecording()
    _record(recording, paths, seconds)
    problem = recording.error or ("" if recording.curves else recording.why_empty(paths))
    if problem:
        return json.dumps({"picture": "", "words": "", "problem": problem})
    return json.dumps({"picture": plot_svg(recording, title) or "", "words": in_words(recording), "problem": ""})


def _record(recording: PlotRecording, paths: Sequence[str], seconds: float) -> None:
    import rclpy
    from rclpy.executors import SingleThreadedExecutor
    from rclpy.node import Node

    from spinbook.kernel.plot.recorder import PlotRecorder
    from spinbook.kernel.plot.recording import RecordingTime

    context = rclpy.Context()
    rclpy.init(context=context, args=[])
    executor = SingleThreadedExecutor(context=context)
    recorder: Node | None = None
    recording_time = RecordingTime(seconds, time.monotonic())
    try:
        recorder = PlotRecorder(paths, recording.note, context)
        executor.add_node(recorder)
        while not recording_time.is_over(recording, time.monotonic()):
            executor.spin_once(timeout_sec=0.05)
    except (LookupError, ValueError) as error:
        recording.error = str(error.args[0] if error.args else error)
    finally:
        if recorder is not None:
            recorder.destroy_node()
        rclpy.shutdown(context=context)
