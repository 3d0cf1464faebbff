"""Reads numbers from messages, each with the name and unit for the axis and the legend."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from ros_in_python.field_path import NoSuchField, Step, fields_in, steps_of, value_at


@dataclass(frozen=True)
class TopicPath:
    """What to draw of a topic: `steps` lead from the message to a value, names and indices in order."""

    topic: str
    steps: tuple[Step, ...]


def resolve(path: str, topics: Iterable[str]) -> TopicPath | None:
    """Split a path into one of these topics and a field. The longest topic that matches wins, as in rqt_plot.

    Return None if no topic matches. Raises ValueError if the rest is not a field.

    >>> resolve('/joint_commands/position[0]', ['/joint_commands'])
    TopicPath(topic='/joint_commands', steps=('position', 0))
    """
    full = path if path.startswith("/") else f"/{path}"
    fitting = [t for t in topics if full == t or (full.startswith(t) and full[len(t)] in "/.[")]
    if not fitting:
        return None
    topic = max(fitting, key=len)
    return TopicPath(topic, steps_of(full[len(topic) :].lstrip("/.")))


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
class PlotQuantity:
    """What one curve shows: `kind` names the axis ("position"), `label` the curve ("left_elbow")."""

    topic: str
    kind: str
    unit: str
    label: str


def quantities(path: TopicPath, message: Any, type_name: str) -> Iterator[tuple[PlotQuantity, float]]:
    """Yield every number at the path in this message, with what it is.

    `type_name` is "package/Type". Raises LookupError if the message has no such field.
    """
    try:
        value = value_at(message, path.steps)
    except IndexError:
        return  # a shorter message than others: nothing to draw from this one
    except NoSuchField as error:
        raise LookupError(f"{path.topic}: {error}") from None
    names = tuple(step for step in path.steps if isinstance(step, str))
    indices = tuple(step for step in path.steps if isinstance(step, int))
    for below, number in _numbers(value, names, indices):
        yield _describe(path, message, type_name, *below), number


def _numbers(
    value: Any, names: tuple[str, ...], indices: tuple[int, ...]
) -> Iterator[tuple[tuple[tuple[str, ...], tuple[int, ...]], float]]:
    if isinstance(value, (bool, int, float)):
        yield (names, indices), float(value)
    elif fields := fields_in(value):
        for name in fields:
            if name not in {"header", "stamp"}:
                yield from _numbers(getattr(value, name), (*names, name), indices)
    elif (not isinstance(value, (str, bytes)) and isinstance(value, Sequence)) or hasattr(value, "tolist"):
        for index, item in enumerate(value):
            yield from _numbers(item, names, (*indices, index))


def _describe(
    path: TopicPath, message: Any, type_name: str, names: tuple[str, ...], indices: tuple[int, ...]
) -> PlotQuantity:
    fields = ((type_name, "/".join(names[:length])) for length in range(len(names), 0, -1))
    unit = next((UNITS[field] for field in fields if field in UNITS), "")
    kind = names[0] if names else path.topic
    label = "/".join(names[1:]) or ("" if indices else "/".join(names))
    if indices:
        joints = getattr(message, "name", None)
        index = indices[-1]
        if isinstance(joints, list) and index < len(joints):
            label = str(joints[index])
        else:
            label = f"{'/'.join(names)}[{index}]"
    return PlotQuantity(path.topic, kind, unit, label or kind)


def stamp_of(message: Any) -> float | None:
    """Return the message's own time in seconds, if it has a header with one."""
    stamp = getattr(getattr(message, "header", None), "stamp", None)
    return (stamp.sec + stamp.nanosec * 1e-9 or None) if stamp is not None else None
