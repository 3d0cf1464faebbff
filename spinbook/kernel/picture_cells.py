"""`%graph`, `%turtle` and `%plot`: pictures of the node graph, of turtlesim's window and of numbers over time."""

from __future__ import annotations

import os
import sys
import tempfile
import time
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from IPython.display import display

from spinbook.graph.layout import drawings
from spinbook.graph.model import NodeGraph
from spinbook.graph.picture import in_words, node_graph_svg
from spinbook.kernel.environment import EXECUTING
from spinbook.kernel.plot.picture import in_words as plot_in_words
from spinbook.kernel.plot.picture import plot_svg
from spinbook.kernel.plot.recording import APPEAR_S, PlotRecording, RecordingTime
from spinbook.kernel.process import KeptProcess
from spinbook.package.cell_line import CellFailed

#: How long looking at the graph may take, in addition to counting (s).
_GRAPH_LIMIT_S = 20.0


def show_graph(seconds: float) -> None:
    """Look at the graph, count messages for this many seconds, and show it. Raises CellFailed."""
    argv = [sys.executable, "-m", "spinbook.graph.watcher", "now", str(seconds)]
    exit_code, output = _run(argv, seconds + _GRAPH_LIMIT_S)
    try:
        graph = NodeGraph.from_json(output[output.index("{") :])
    except ValueError:
        raise CellFailed(output or f"The graph could not be read (exit code {exit_code}).") from None
    if not graph.nodes:
        print("No nodes. Run a cell that begins with %%node.")
        return
    show_picture({"image/svg+xml": node_graph_svg(graph, standalone=True)}, in_words(drawings(graph)))


def _run(argv: list[str], seconds: float) -> tuple[int | None, str]:
    """Run a program for at most this many seconds; return its exit code and what it printed."""
    process = KeptProcess(argv, os.environ, Path.cwd())
    try:
        return process.wait(seconds).exit, process.read_all()[0].decode(errors="replace").strip()
    finally:
        process.close()


def show_picture(pictures: Mapping[str, Any], words: str, handle: Any = None, **size: int) -> Any:
    """Show a picture, given by media type, in place of the one with this handle if there is one. Return its handle.

    `words` say what it shows, `size` is its width or height (px).
    """
    bundle = {**pictures, "text/plain": words}
    metadata = {kind: {"alt": words, **size} for kind in pictures if kind.startswith("image/")}
    if handle is None:
        return display(bundle, raw=True, metadata=metadata, display_id=True)
    handle.update(bundle, raw=True, metadata=metadata)
    return handle


#: How long the turtle may take to answer, listening to the real one's poses included (s).
_TURTLE_LIMIT_S = 30.0


def show_turtle() -> None:
    """Ask the running turtlesim for its picture and show it. Raises CellFailed if none answers."""
    with tempfile.TemporaryDirectory(prefix="spinbook-") as folder:
        file = Path(folder) / "turtle.svg"
        argv = [sys.executable, "-m", "ros_in_python.turtlesim", os.fspath(file)]
        exit_code, output = _run(argv, _TURTLE_LIMIT_S)
        if exit_code != 0 or not file.exists():
            raise CellFailed(output or "turtlesim did not answer. Is it running? ros2 run turtlesim turtlesim_node")
        show_picture(
            {"image/svg+xml": file.read_text(encoding="utf-8")},
            "turtlesim's window: the turtle and the trail it has drawn",
        )


#: The time between two drawings of a live plot (s).
_REDRAW_S = 0.5


def show_plot(paths: list[str], seconds: float, title: str) -> None:
    """Record these paths for this many seconds from the first sample on, and show the plot. Raises CellFailed."""
    recording = PlotRecording()
    handle = record("spinbook.kernel.plot.recorder", paths, recording, seconds, partial(_show, title=title))
    if recording.error:
        raise CellFailed(recording.error)
    if not recording.curves:
        raise CellFailed(recording.why_empty(paths))
    _show(recording, handle, title)


_Recording = TypeVar("_Recording", bound=PlotRecording)


def record(
    module: str,
    arguments: list[str],
    recording: _Recording,
    seconds: float,
    show: Callable[[_Recording, Any], Any],
    appear_s: float = APPEAR_S,
) -> Any:
    """Record for this many seconds what a recorder prints, and show it meanwhile if somebody watches.

    `module` is the recorder; `show` gets the handle of the live picture, None at first, and returns it. The first
    sample may take `appear_s` seconds. Return the handle.
    """
    process = KeptProcess([sys.executable, "-u", "-m", module, *arguments], os.environ, Path.cwd())
    try:
        return _follow(process, recording, RecordingTime(seconds, time.monotonic(), appear_s), show)
    finally:
        process.stop((0.5, 0.5))
        process.close()


def _follow(
    process: KeptProcess, recording: _Recording, recording_time: RecordingTime, show: Callable[[_Recording, Any], Any]
) -> Any:
    watched = EXECUTING not in os.environ
    handle: Any = None
    drawn = 0.0
    try:
        while True:
            recording.take(process.read_lines())
            now = time.monotonic()
            if recording.error or not process.status.running or recording_time.is_over(recording, now):
                return handle
            if watched and recording.curves and now - drawn > _REDRAW_S:
                handle = show(recording, handle)
                drawn = time.monotonic()
            time.sleep(0.03)
    except KeyboardInterrupt:
        return handle


def _show(recording: PlotRecording, handle: Any, title: str) -> Any:
    """Show what has been recorded so far; the picture moves if nobody was watching."""
    svg = plot_svg(recording, title, moves=EXECUTING in os.environ)
    return show_picture({"image/svg+xml": svg}, plot_in_words(recording), handle)
