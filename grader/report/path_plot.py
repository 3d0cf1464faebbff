"""The plot of a closed loop: the path in the plane, the student's over the solution's, with the goals.

What the node publishes says little there: each node finds a way of its own, and a value that differs from the
solution's is not wrong.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from markupsafe import Markup

from grader.exercise.exercise import Exercise, Topic
from grader.recording.recording import ReceivedMessage, Recording, SentMessage
from grader.report.curves import findings
from grader.report.pages import template
from ros_in_python.axis_marks import round_values
from ros_in_python.field_path import NoSuchField, field_of

if TYPE_CHECKING:
    from grader.grading.grade import Grade

Place = tuple[float, float]

#: A place that is further away than this is not drawn.
FURTHEST = 1e6


@dataclass(frozen=True)
class PlanePath:
    """Two fields of a topic on which a world says where something is.

    `expected` and `got` are the solution's and the student's way. `goals` are the places that were published on another
    topic with the same fields. `wrong` is the time (s) and the place of the first finding of a public check, if it has
    a time.
    """

    fields: tuple[str, str]
    unit: str
    expected: tuple[Place, ...]
    got: tuple[Place, ...]
    goals: tuple[Place, ...]
    wrong: tuple[float, Place] | None


def path_of(grade: Grade, exercise: Exercise, scenario: str) -> PlanePath | None:
    """Return the path in this scenario; None if it is not a closed loop with a position in the plane."""
    student, reference = grade.recordings[scenario], grade.references[scenario]
    for topic in exercise.inputs:
        fields = _plane(topic)
        goals = [other for other in exercise.inputs if other is not topic and fields and _plane(other) == fields]
        if not fields or not _is_moved(student, reference, topic, bool(goals)):
            continue
        way = list(_way(student, topic, fields))
        return PlanePath(
            fields,
            topic.units[fields[0]],
            tuple(place for _, place in _way(reference, topic, fields)),
            tuple(place for _, place in way),
            tuple(dict.fromkeys(place for other in goals for _, place in _way(student, other, fields))),
            _wrong(grade, scenario, way),
        )
    return None


def _plane(topic: Topic) -> tuple[str, str] | None:
    """Return the first two fields with the same unit, such as x and y."""
    names = list(topic.units)
    pairs = ((a, b) for i, a in enumerate(names) for b in names[i + 1 :] if topic.units[a] == topic.units[b])
    return next(pairs, None)


def _is_moved(student: Recording, reference: Recording, topic: Topic, has_goal: bool) -> bool:
    """Return whether the node moves what is published there: its way differs, or it has a goal and many places."""
    mine, its = (
        [message.fields for message in run.sent if message.topic == topic.name] for run in (student, reference)
    )
    return mine != its or (has_goal and len(mine) > 2)


def _way(recording: Recording, topic: Topic, fields: tuple[str, str]) -> Iterator[tuple[float, Place]]:
    messages: list[SentMessage | ReceivedMessage] = [*recording.sent, *recording.received]
    for message in sorted((one for one in messages if one.topic == topic.name), key=lambda one: one.at_ns):
        try:
            x, y = (float(field_of(message.fields, name)) for name in fields)
        except (NoSuchField, TypeError, ValueError):
            continue
        if math.hypot(x, y) < FURTHEST:
            yield message.at, (x, y)


def _wrong(grade: Grade, scenario: str, way: list[tuple[float, Place]]) -> tuple[float, Place] | None:
    times = [finding.at for finding in findings(grade, scenario) if finding.at is not None]
    before = [(at, place) for at, place in way if times and at <= times[0] + 1e-6]
    return (times[0], before[-1][1]) if before else None


#: In units of the picture.
WIDTH, SIDE, LEFT, TOP, BOTTOM = 500, 320, 52, 40, 40


def path_plot(path: PlanePath) -> str:
    """Return the plot as SVG text. One unit is as long in both directions."""
    places = [*path.expected, *path.got, *path.goals] or [(0.0, 0.0)]
    (left, right), (low, high) = ((min(values), max(values)) for values in zip(*places, strict=True))
    span = max(right - left, high - low) * 1.16 or 1.0
    x0, y0 = (left + right - span) / 2, (low + high - span) / 2

    def at(place: Place) -> Place:
        return (round(LEFT + SIDE * (place[0] - x0) / span, 1), round(TOP + SIDE * (1 - (place[1] - y0) / span), 1))

    return template("report/path_plot.svg.j2").render(
        path=path,
        description=describe(path),
        width=WIDTH,
        height=TOP + SIDE + BOTTOM,
        left=LEFT,
        top=TOP,
        side=SIDE,
        expected=Markup(" ".join("{:g},{:g}".format(*at(place)) for place in path.expected)),
        got=Markup(" ".join("{:g},{:g}".format(*at(place)) for place in path.got)),
        start=at(path.got[0]) if path.got else None,
        goals=[at(goal) for goal in path.goals],
        wrong=at(path.wrong[1]) if path.wrong else None,
        wrong_at=f"{path.wrong[0]:.2f} s" if path.wrong else "",
        x_marks=[(at((value, y0))[0], f"{value:g}") for value in round_values(x0, x0 + span)],
        y_marks=[(at((x0, value))[1], f"{value:g}") for value in round_values(y0, y0 + span)],
    )


def describe(path: PlanePath) -> str:
    """Describe the plot in words."""
    x, y = path.fields
    text = f"The path in the plane of {x} and {y}, yours drawn over the solution's."
    if path.goals:
        places = " and ".join(f"{x} {gx:.3g}, {y} {gy:.3g}" for gx, gy in path.goals)
        text += f" The {'goal is' if len(path.goals) == 1 else 'goals are'} at {places}."
    if path.wrong:
        at, (wx, wy) = path.wrong
        text += f" The cross marks where it went wrong: {x} {wx:.3g}, {y} {wy:.3g} at {at:.2f} s."
    return text
