"""`%plot` in a page: a terminal's process records and draws, as the notebook does."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node

from spinbook.kernel.plot.picture import in_words, plot_svg
from spinbook.kernel.plot.recorder import PlotRecorder
from spinbook.kernel.plot.recording import APPEAR_S, PlotRecording, RecordingTime


def plot(paths: Sequence[str], seconds: float, title: str) -> dict[str, str]:
    """Record these paths for this many seconds from the first sample on.

    Return `picture`, `words` and `problem`, "" if there is none.
    """
    recording = PlotRecording()
    record(recording, lambda context: PlotRecorder(paths, recording.note, context), seconds)
    problem = recording.error or ("" if recording.curves else recording.why_empty(paths))
    if problem:
        return {"picture": "", "words": "", "problem": problem}
    return {"picture": plot_svg(recording, title), "words": in_words(recording), "problem": ""}


def record(
    recording: PlotRecording, new_recorder: Callable[[Context], Node], seconds: float, appear_s: float = APPEAR_S
) -> None:
    """Record for this many seconds from the first sample on, which may take `appear_s` seconds, or until Ctrl-C."""
    context = rclpy.Context()
    rclpy.init(context=context, args=[])
    executor = SingleThreadedExecutor(context=context)
    recorder: Node | None = None
    recording_time = RecordingTime(seconds, time.monotonic(), appear_s)
    try:
        recorder = new_recorder(context)
        executor.add_node(recorder)
        while not recording_time.is_over(recording, time.monotonic()):
            executor.spin_once(timeout_sec=0.05)
    except KeyboardInterrupt:
        pass
    except (LookupError, ValueError) as error:
        recording.error = str(error.args[0] if error.args else error)
    finally:
        if recorder is not None:
            recorder.destroy_node()
        rclpy.shutdown(context=context)
