"""Takes numbers out of messages, each with the name and unit that an axis and a legend need."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from spinbook.kernel.recorder_lines import read_lines

_STEP = re.compile(r"([A-Za-z]\w*)((?:\[\d+\])*)")


@dataclass(frozen=True)
class TopicPath:
    """What to draw of a topic: `steps` lead from the message to a value, names and indices in order."""

    topic: str
    steps: tuple[str | int, ...]

    @property
    def field(self) -> str:
        """The steps as they are written: `position[0]`, `linear/x`."""
        text = ""
        for step in self.steps:
            text += f"[{step}]" if isinstance(step, int) else f"/{step}"
        return text.lstrip("/")


def resolve(path: str, topics: Iterable[str]) -> TopicPath | None:
    """Split a path into one of these topics and a field. The longest topic that fits is meant, as in rqt_plot.

    None if no topic fits. Raises ValueError if the rest is not a field.

    >>> resolve('/joint_commands/position[0]', ['/joint_commands'])
    TopicPath(topic='/joint_commands', steps=('position', 0))
    """
    full = path if path.startswith("/") else f"/{path}"
    fitting = [t for t in topics if full == t or (full.startswith(t) and full[len(t)] in "/.[")]
    if not fitting:
        return None
    topic = max(fitting, key=len)
    return TopicPath(topic, _steps(full[len(topic) :].lstrip("/."), path))


def _steps(rest: str, path: str) -> tuple[str | int, ...]:
    steps: list[str | int] = []
    for part in re.split(r"[/.]", rest) if rest else []:
        match = _STEP.fullmatch(part)
        if not match:
            raise ValueError(f"`{part}` in `{path}` is not a field. Write for example /joint_commands/position[0].")
        steps.append(match.group(1))
        steps += [int(index) for index in re.findall(r"\d+", match.group(2))]
    return tuple(steps)


#: (message type, first field) -> unit, from the comments of the interface files (REP 103: SI units).
UNITS = {
    ("sensor_msgs/JointState", "position"): "rad",
    ("sensor_msgs/JointState", "velocity"): "rad/s",
    ("sensor_msgs/JointState", "effort"): "N·m",
    ("geometry_msgs/Twist", "linear"): "m/s",
    ("geometry_msgs/Twist", "angular"): "rad/s",
    ("geometry_msgs/TwistStamped", "twist/linear"): "m/s",
    ("geometry_msgs/TwistStamped", "twist/angular"): "rad/s",
    ("geometry_msgs/Pose2D", "x"): "m",
    ("geometry_msgs/Pose2D", "y"): "m",
    ("geometry_msgs/Pose2D", "theta"): "rad",
    ("geometry_msgs/Point", "x"): "m",
    ("geometry_msgs/Point", "y"): "m",
    ("geometry_msgs/Point", "z"): "m",
    ("sensor_msgs/Imu", "angular_velocity"): "rad/s",
    ("sensor_msgs/Imu", "linear_acceleration"): "m/s²",
    ("sensor_msgs/Range", "range"): "m",
    ("sensor_msgs/LaserScan", "ranges"): "m",
    ("sensor_msgs/Temperature", "temperature"): "°C",
    ("turtlesim/Pose", "theta"): "rad",
    ("turtlesim/Pose", "linear_velocity"): "1/s",
    ("turtlesim/Pose", "angular_velocity"): "rad/s",
}


@dataclass(frozen=True)
class Quantity:
    """What one curve shows: `kind` names the axis ("position"), `label` the curve ("left_elbow")."""

    topic: str
    kind: str
    unit: str
    label: str


def quantities(path: TopicPath, message: Any, type_name: str) -> Iterator[tuple[Quantity, float]]:
    """Every number that the path leads to in this message, with what it is.

    `type_name` is "package/Type". Raises LookupError if the message has no such field.
    """
    value: Any = message
    names: list[str] = []
    indices: list[int] = []
    for step in path.steps:
        if isinstance(step, int):
            if step >= len(value):
                return  # a shorter message than others: nothing to draw from this one
            value = value[step]
            indices.append(step)
        else:
            value = _field(value, step, path)
            names.append(step)
    for below, number in _numbers(value, (*names,), tuple(indices)):
        yield _describe(path, message, type_name, *below), number


def _field(value: Any, step: str, path: TopicPath) -> Any:
    fields = value.get_fields_and_field_types() if hasattr(value, "get_fields_and_field_types") else {}
    if step not in fields:
        there = ", ".join(fields) or "no fields"
        raise LookupError(f"`{path.field}` of {path.topic}: there is no `{step}`. It has: {there}.")
    return getattr(value, step)


def _numbers(
    value: Any, names: tuple[str, ...], indices: tuple[int, ...]
) -> Iterator[tuple[tuple[tuple[str, ...], tuple[int, ...]], float]]:
    if isinstance(value, (bool, int, float)):
        yield (names, indices), float(value) if not isinstance(value, bool) else float(int(value))
    elif hasattr(value, "get_fields_and_field_types"):
        for name in value.get_fields_and_field_types():
            if name not in {"header", "stamp"}:
                yield from _numbers(getattr(value, name), (*names, name), indices)
    elif (not isinstance(value, (str, bytes)) and isinstance(value, Sequence)) or hasattr(value, "tolist"):
        for index, item in enumerate(value):
            yield from _numbers(item, names, (*indices, index))


def _describe(
    path: TopicPath, message: Any, type_name: str, names: tuple[str, ...], indices: tuple[int, ...]
) -> Quantity:
    unit = next(
        (UNITS[type_name, key] for key in _prefixes(names) if (type_name, key) in UNITS),
        "",
    )
    kind = names[0] if names else path.topic
    label = "/".join(names[1:]) or ("" if indices else "/".join(names)) or ""
    if indices:
        joints = getattr(message, "name", None)
        index = indices[-1]
        if isinstance(joints, list) and index < len(joints):
            label = str(joints[index])
        else:
            label = f"{'/'.join(names)}[{index}]"
    return Quantity(path.topic, kind, unit, label or kind)


def _prefixes(names: tuple[str, ...]) -> Iterator[str]:
    for length in range(len(names), 0, -1):
        yield "/".join(names[:length])


def stamp_of(message: Any) -> float | None:
    """The message's own time in seconds, if it has a header with one."""
    stamp = getattr(getattr(message, "header", None), "stamp", None)
    if stamp is None or (stamp.sec == 0 and stamp.nanosec == 0):
        return None
    seconds = stamp.sec + stamp.nanosec * 1e-9
    return seconds if math.isfinite(seconds) else None


@dataclass
class Curve:
    """One quantity over time: `times` and `values` have the same length; times in s, on the messages' own clock."""

    quantity: Quantity
    times: list[float] = field(default_factory=list)
    values: list[float] = field(default_factory=list)


@dataclass
class Recording:
    """Curves in the order in which they first appeared, and what is still waited for."""

    curves: dict[Quantity, Curve] = field(default_factory=dict)
    waiting: list[str] = field(default_factory=list)
    published: list[str] = field(default_factory=list)
    error: str | None = None
    is_looking: bool = False
    """Whether the recorder takes part in ROS yet."""

    def take(self, lines: Iterable[str]) -> None:
        """Take in lines that the recorder printed."""
        for kind, rest in read_lines(lines):
            if kind == "sample":
                topic, axis, unit, label, when, value = rest
                quantity = Quantity(topic, axis, unit, label)
                curve = self.curves.setdefault(quantity, Curve(quantity))
                curve.times.append(when)
                curve.values.append(value)
            elif kind == "looking":
                self.is_looking = True
            elif kind == "waiting":
                self.waiting, self.published = rest
            elif kind == "error":
                self.error = rest[0]

    @property
    def start(self) -> float:
        """The time of the first sample (s)."""
        return min((curve.times[0] for curve in self.curves.values()), default=0.0)
