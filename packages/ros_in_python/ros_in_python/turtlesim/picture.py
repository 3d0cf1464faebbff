"""Fetches the world from the running turtlesim, ours or the real one, and draws it."""

from __future__ import annotations

import io
import math
import time
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from matplotlib.transforms import Affine2D
from rclpy.exceptions import InvalidServiceNameException
from rclpy.node import Node
from std_srvs.srv import Trigger

from groundwork.files import write_if_changed
from ros_in_python.ros2.opening import open_graph
from ros_in_python.turtlesim.events import DT, PIXELS_PER_UNIT, SIDE, Pen
from ros_in_python.turtlesim.messages import Pose
from ros_in_python.turtlesim.moving import moving_svg
from ros_in_python.turtlesim.trail import Point, Track, Trail
from ros_in_python.turtlesim.turtle_shapes import turtle_shapes
from ros_in_python.turtlesim.world_picture import BLUE, Color, TurtlePicture, WorldPicture, caption, strokes, tracks

#: The world's side on paper, and the margin around it, in inches.
_SIDE_IN, _LEFT, _RIGHT, _BOTTOM, _TOP = 4.4, 0.42, 0.12, 0.36, 0.34
#: Dots per inch of a PNG.
_DPI = 120
_INK = "#3a3f4b"
_POINTS_PER_INCH = 72


def draw(world: WorldPicture) -> Figure:
    """Draw the world as a figure: background, trails in their colours and widths, turtles; axes in units."""
    width, height = _LEFT + _SIDE_IN + _RIGHT, _BOTTOM + _SIDE_IN + _TOP
    figure = Figure(figsize=(width, height), facecolor="white")
    FigureCanvasAgg(figure)
    axes = figure.add_axes((_LEFT / width, _BOTTOM / height, _SIDE_IN / width, _SIDE_IN / height))
    _prepare(axes, world)
    pixel = _SIDE_IN * _POINTS_PER_INCH / world.size / PIXELS_PER_UNIT
    for stroke in world.trails:
        xs, ys = zip(*stroke.points, strict=True) if stroke.points else ((), ())
        axes.plot(
            xs,
            ys,
            color=_shade(stroke.color),
            linewidth=stroke.width * pixel,
            solid_capstyle="projecting",
            solid_joinstyle="round",
        )
    for coat, turtle in enumerate(world.turtles):
        _draw_turtle(axes, turtle, coat)
        if len(world.turtles) > 1:
            _name(axes, turtle, world.size)
    return figure


def save(world: WorldPicture, file: Path) -> None:
    """Write the picture to a .png or .svg, all at once; the same bytes for the same world.

    Raises:
        ValueError: if the name ends in anything else.
        OSError: if the file can't be written.
    """
    kind = file.suffix.lower().removeprefix(".")
    if kind not in ("png", "svg"):
        raise ValueError(f"{file}: a picture's name must end in .png or .svg")
    # Without dates, versions and random ids, the same world gives the same bytes.
    metadata = {"Date": None, "Creator": None} if kind == "svg" else {"Software": None}
    picture = io.BytesIO()
    with mpl.rc_context({"svg.hashsalt": "turtlesim"}):
        draw(world).savefig(picture, format=kind, dpi=_DPI, metadata=metadata)
    write_if_changed(file, picture.getvalue())


def _prepare(axes: Axes, world: WorldPicture) -> None:
    axes.set(xlim=(0, world.size), ylim=(0, world.size), aspect="equal", facecolor=_shade(world.background))
    ticks = range(0, math.floor(world.size) + 1, 2 if world.size < 30 else 10)
    axes.set_xticks(ticks)
    axes.set_yticks(ticks)
    axes.tick_params(labelsize=8, color=_INK, labelcolor=_INK, length=3, width=0.8, pad=2.5)
    for spine in axes.spines.values():
        spine.set(color=_INK, linewidth=0.8)
    axes.grid(color="white", alpha=0.13, linewidth=0.6)
    axes.set_axisbelow(True)
    look: dict[str, Any] = {"fontsize": 8.5, "color": _INK}
    axes.text(1.0, -0.052, "x", transform=axes.transAxes, ha="right", va="center", style="italic", **look)
    axes.text(-0.046, 1.0, "y", transform=axes.transAxes, ha="center", va="top", style="italic", **look)
    axes.set_title(caption(world), loc="left", pad=6, parse_math=False, **look)


def _draw_turtle(axes: Axes, turtle: TurtlePicture, coat: int) -> None:
    place = Affine2D().rotate(turtle.theta).translate(turtle.x, turtle.y) + axes.transData
    for shape in turtle_shapes(coat):
        shape.set_transform(place)
        shape.set_clip_path(axes.patch)
        shape.set_zorder(10 + coat)
        axes.add_artist(shape)


def _name(axes: Axes, turtle: TurtlePicture, size: float) -> None:
    """Write a turtle's name below it, or above it near the lower wall; readable on any background."""
    below = turtle.y > 1.2
    x = min(max(turtle.x, 0.6), size - 0.6)
    axes.text(
        x,
        turtle.y + (-0.62 if below else 0.62),
        turtle.name,
        ha="center",
        va="top" if below else "bottom",
        fontsize=7.5,
        color="white",
        zorder=30,
        parse_math=False,
        path_effects=[withStroke(linewidth=2, foreground=_INK)],
    )


def _shade(color: Color) -> tuple[float, float, float]:
    r, g, b = (part / 255 for part in color)
    return (r, g, b)


#: The type of a turtle's poses.
POSE = "turtlesim/msg/Pose"


class PoseListener:
    """Listens to one turtle's poses on `topic`, from the first `look` that finds it; `node` must be spun meanwhile."""

    def __init__(self, node: Node, topic: str) -> None:
        self.topic = topic
        self._turtle = topic.split("/")[-2]
        self._node = node
        self._trail = Trail()
        self._track = Track()
        self._last: Any = None
        self._last_tick = -1
        self._listening = False

    def look(self) -> None:
        """Listen as soon as somebody publishes poses."""
        if not self._listening and POSE in self._published_types():
            self._node.create_subscription(Pose, self.topic, self._on_pose, 50)
            self._listening = True

    def _published_types(self) -> list[str]:
        return sorted({each.topic_type for each in self._node.get_publishers_info_by_topic(self.topic)})

    def _on_pose(self, pose: Pose) -> None:
        here: Point = (pose.x, pose.y)
        before = here if self._last is None else (self._last.x, self._last.y)
        if here != before:
            self._trail.line(self._turtle, Pen(), before, here)
        self._last = pose
        # Poses do not say their time; two that arrive together are a tick apart.
        self._last_tick = max(self._last_tick + 1, round(time.monotonic() / DT))
        self._track.add(self._last_tick, pose.x, pose.y, pose.theta, Pen())

    def picture(self, incomplete: str) -> WorldPicture | None:
        """Return the path so far, in turtlesim's usual colours, which poses don't say; None if there was no pose."""
        if self._last is None:
            return None
        turtle = TurtlePicture(self._turtle, self._last.x, self._last.y, self._last.theta, Pen())
        trails, moved = strokes(self._trail.strokes), tracks({self._turtle: self._track})
        return WorldPicture(SIDE, BLUE, (turtle,), trails, incomplete, moved)

    def unreadable_types(self) -> list[str]:
        """Return the types that are published on the topic and are not a turtle's pose."""
        return [found for found in self._published_types() if found != POSE]


#: The node's full name, unless it was remapped.
NODE = "/turtlesim"
#: How long to look for a turtlesim node, and how long to listen to one that has no picture, in s.
TIMEOUT_S, LISTEN_S = 5.0, 7.0
# The node has been found and is answering: a big picture on a busy machine may take long.
_ANSWER_S = 30.0


class NoPictureError(Exception):
    """There is no picture; the message says why and what to do."""


def fetch(timeout_s: float = TIMEOUT_S, listen_s: float = LISTEN_S, node: str = NODE) -> WorldPicture:
    """Return the world as the turtlesim node `node` reports it.

    Our own node is asked for its picture, for `timeout_s` s at most until it is found. Where none answers to that,
    as with the turtlesim of a ROS installation, the picture is the path of turtle1 as heard on its pose topic within
    `listen_s` s. Works next to other ROS code in the same process: it has its own context.

    Raises:
        NoPictureError: if nothing is found or heard.
        CommandError: if rclpy can't work in this environment.
    """
    namespace = node.rpartition("/")[0]
    with open_graph(node_name="turtle_picture") as graph:
        heard = PoseListener(graph.node, f"{namespace}/turtle1/pose")
        try:
            client = graph.node.create_client(Trigger, f"{node}/picture")
        except InvalidServiceNameException as error:
            raise NoPictureError(f"{node!r} is not a valid node name: give one such as {NODE}") from error

        def look(is_over: bool = False) -> bool:
            heard.look()
            return is_over

        start = time.monotonic()
        if graph.spin_until(lambda: look(client.service_is_ready()), timeout_s):
            answer = client.call_async(Trigger.Request())
            graph.spin_until(answer.done, _ANSWER_S)
            return _read(node, answer.result() if answer.done() else None)
        graph.spin_until(look, start + listen_s - time.monotonic())
        return _heard(heard, node, time.monotonic() - start)


def _read(node: str, answer: Trigger.Response | None) -> WorldPicture:
    if answer is None:
        raise NoPictureError(f"{node} did not answer within {_ANSWER_S:.0f} s. Is it stopped or very busy?")
    try:
        return WorldPicture.from_json(answer.message)
    except ValueError as error:
        raise NoPictureError(f"{node}/picture answered with something else: {error}") from error


def _heard(heard: PoseListener, node: str, seconds: float) -> WorldPicture:
    picture = heard.picture(f"only what was heard in {seconds:.0f} s")
    if picture is not None:
        return picture
    if types := heard.unreadable_types():
        raise NoPictureError(
            f"{heard.topic} carries {', '.join(types)}, which this Python can't read: "
            "source the ROS installation that the turtlesim belongs to."
        )
    raise NoPictureError(
        f"No turtlesim is running: no {node}, and nothing on {heard.topic} for {seconds:.0f} s.\n"
        "Start one with `ros2 run turtlesim turtlesim_node`. If one runs, does it have the same ROS_DOMAIN_ID?"
    )


def write(file: Path, timeout_s: float, listen_s: float, node: str, moving: Path | None = None) -> WorldPicture:
    """Fetch the world and write its picture to `file`, and the moving one to `moving` if a turtle has moved.

    Raises:
        NoPictureError: if there is none, or it can't be written there.
    """
    if file.suffix.lower() not in (".png", ".svg"):
        raise NoPictureError(f"{file}: a picture's name must end in .png or .svg")
    world = fetch(timeout_s, listen_s, node)
    try:
        save(world, file)
        if moving is not None and (svg := moving_svg(world)) is not None:
            moving.write_text(svg, encoding="utf-8")
    except OSError as error:
        raise NoPictureError(f"{error.filename or file} can't be written: {error.strerror}") from error
    return world
