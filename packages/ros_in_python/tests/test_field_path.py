"""Paths into messages, into real ones and into their fields as dictionaries."""

from __future__ import annotations

from typing import Any

import pytest
from sensor_msgs.msg import JointState

from ros_in_python.field_path import NoSuchField, Step, field_of, fields_in, steps_of, value_at, written

FIELDS = {"header": {"stamp": {"sec": 3}}, "points": [{"x": 1.0}, {"x": 2.5}], "matrix": [[1, 2], [3, 4]], "data": 7}
REAL = JointState(name=["elbow", "wrist"], position=[0.5, 1.5])


@pytest.mark.parametrize(
    ("path", "steps"),
    [
        ("", ()),
        ("position", ("position",)),
        ("position[0]", ("position", 0)),
        ("matrix[1][2]", ("matrix", 1, 2)),
        ("points[2].x", ("points", 2, "x")),
        ("linear/x", ("linear", "x")),
    ],
)
def test_names_are_separated_by_dots_or_slashes_and_indices_are_in_brackets(path: str, steps: tuple[Step, ...]) -> None:
    assert steps_of(path) == steps
    assert written(steps) == path.replace("/", ".")


@pytest.mark.parametrize("path", ["position[", "position[x]", "1st", "a..b", "position[-1]", "[0]"])
def test_what_is_not_a_field_is_refused_with_an_example(path: str) -> None:
    with pytest.raises(ValueError, match=r"is not a field\. Write for example position\[0\] or header\.stamp\."):
        steps_of(path)


@pytest.mark.parametrize(
    ("message", "path", "value"),
    [
        (FIELDS, "header.stamp.sec", 3),
        (FIELDS, "points[1].x", 2.5),
        (FIELDS, "matrix[1][0]", 3),
        (FIELDS, "", FIELDS),
        (REAL, "position[1]", 1.5),
        (REAL, "name[0]", "elbow"),
        (REAL, "header.stamp.nanosec", 0),
    ],
)
def test_a_path_leads_to_a_value(message: Any, path: str, value: object) -> None:
    assert field_of(message, path) == value


@pytest.mark.parametrize(
    ("message", "path", "there"),
    [
        (FIELDS, "date", "header, points, matrix, data"),
        (FIELDS, "header.frame_id", "stamp"),
        (FIELDS, "data[0]", "none"),
        (FIELDS, "header[0]", "stamp"),
        (REAL, "positions", "header, name, position, velocity, effort"),
        (REAL, "position.x", "none"),
        (REAL, "name[0][0]", "none"),
    ],
)
def test_a_field_that_is_not_there_is_an_error_with_those_that_are(message: Any, path: str, there: str) -> None:
    with pytest.raises(NoSuchField) as error:
        field_of(message, path)
    assert str(error.value) == f"there is no field `{path}`. The fields are: {there}."


def test_an_element_that_the_list_does_not_have_is_an_index_error() -> None:
    with pytest.raises(IndexError):
        value_at(REAL, ("position", 2))


def test_only_messages_and_dictionaries_have_fields() -> None:
    assert fields_in(REAL) == ("header", "name", "position", "velocity", "effort")
    assert fields_in(3.0) == ()
