"""Takes numbers out of messages, each with the name and the unit that an axis and a legend need."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from spinbook.runtime.plot.topic_path import TopicPath

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

    `type_name` is "package/Type". Raises LookupError where the message has no such field.
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
