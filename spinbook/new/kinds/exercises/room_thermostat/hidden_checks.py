"""Checks that students may not read: the rest of `room_thermostat`. Every rule that they rely on is in task.md."""

from __future__ import annotations

from grader.checking import Run, check

SWITCHES = ["test_switches_the_heater"]
CHANGES = ["test_parameters_set_while_it_runs"]


@check(
    points=3,
    hint="A callback added with add_on_set_parameters_callback says whether values may change.",
    depends=SWITCHES,
    misconception="refuses nothing",
    rule="A value outside of its range is refused, with a reason, and everything continues as before.",
)
def test_refuses_what_is_out_of_range(refused: Run) -> None:
    """It refuses values outside their ranges, and continues as before."""
    refused.must_refuse("target")
    refused.must_refuse("margin")
    refused.must_match("data")
    for change in refused.recording.parameters:
        if not change.reason:
            part = f"parameter {change.name}"
            refused.wrong_at(change.at, "a reason was expected, got none.", part, "a reason", "none")


@check(
    points=2,
    hint="5.0 and 30.0 are allowed, and so are 0.0 and 5.0.",
    depends=CHANGES,
    rule="The ends of the ranges are allowed.",
)
def test_takes_the_ends_of_the_ranges(ends: Run) -> None:
    """It accepts the values at the ends of their ranges."""
    ends.must_take("target")
    ends.must_take("margin")
    ends.must_match("data")


@check(
    points=1,
    hint="A parameter that is declared with 20.0 accepts only doubles.",
    depends=SWITCHES,
    rule="A value of another type is refused, such as the integer 22.",
)
def test_refuses_other_types(types: Run) -> None:
    """It refuses an integer and a string for a double, and continues as before."""
    types.must_refuse("target", 22)
    types.must_refuse("margin", "wide")
    types.must_match("data")


@check(
    points=1,
    hint="Compare the names and the queue depths in __init__ with the task.",
    depends=SWITCHES,
    rule="Its node is called room_thermostat.",
)
def test_node_is_as_described(read: Run) -> None:
    """The node has the name, the parameters and the quality of service of the task."""
    read.must_be_as_declared()
    read.must_have_parameter("target", 20.0)
    read.must_have_parameter("margin", 0.5)
