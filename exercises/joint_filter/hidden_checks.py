"""The harder scenarios of `joint_filter`. Every rule that they rely on is in task.md."""

from __future__ import annotations

from grader.checking import Run, check, fail

NAMED = "test_node_is_called_joint_filter"
FILTERS, GAIN = ["test_filters_with_the_default"], ["test_gain_of_the_start", NAMED]


@check(
    points=4,
    hint="A gain of 1.0 is allowed.",
    depends=GAIN,
    rule="Refused: a gain of 0.0 or less, above 1.0, not a number, or of another type",
)
def test_gain_of_one(after_refusal: Run) -> None:
    """A gain of exactly 1.0 is accepted."""
    after_refusal.must_take("gain", 1.0)


@check(
    points=3,
    hint="Pass the default to declare_parameter().",
    depends=[NAMED],
    rule="Declared, as a double, with its default 0.5.",
)
def test_gain_can_be_read(default: Run) -> None:
    """The parameter gain can be read, and is 0.5."""
    default.must_have_parameter("gain")


@check(
    points=10,
    hint="Use a range in the descriptor, and an on-set callback that refuses 0.0.",
    depends=GAIN,
    misconception="takes every gain",
    rule="Refused: a gain of 0.0 or less, above 1.0, not a number, or of another type",
)
def test_refuses_what_is_not_allowed(refused: Run) -> None:
    """It refuses a gain of 0.0 or less, above 1.0, or not a number."""
    refused.must_refuse("gain")


@check(
    points=5,
    hint="Refuse before anything changes.",
    depends=["test_refuses_what_is_not_allowed"],
    rule="The gain stays as it was.",
)
def test_goes_on_after_a_refusal(refused: Run) -> None:
    """After a refusal, the gain is unchanged."""
    refused.must_have_parameter("gain")
    refused.must_match("position", per="name")


@check(
    points=5,
    hint="A parameter keeps the type of its default, unless the descriptor says otherwise.",
    depends=GAIN,
    rule="Refused: a gain of 0.0 or less, above 1.0, not a number, or of another type (the integer 1).",
)
def test_refuses_other_types(other_types: Run) -> None:
    """It refuses an integer, a string and a bool."""
    other_types.must_refuse("gain")


@check(
    points=3,
    hint="SetParametersResult has a field for the reason.",
    depends=["test_refuses_what_is_not_allowed"],
    rule="A refusal has a reason.",
)
def test_refuses_with_a_reason(refused: Run) -> None:
    """Each refusal has a reason."""
    for change in refused.recording.parameters:
        if change.taken is False and not change.reason:
            refused.wrong_at(change.at, f"{change.value} was refused without a reason.", "", "a reason", "none")


@check(
    points=6,
    hint="Remember positions by name, not by index in the list.",
    depends=FILTERS,
    misconception="joints by index",
    rule="Go by name, never by index: the order of the joints may change.",
)
def test_joints_in_another_order(reordered: Run) -> None:
    """It filters each joint by its name, in whatever order they arrive."""
    reordered.must_match("position", per="name")


@check(
    points=5,
    hint="Keep the smooth position of each joint, even when it is missing.",
    depends=FILTERS,
    rule="A joint that was missing from some messages continues from its last smooth position.",
)
def test_missing_joint(missing_joint: Run) -> None:
    """A joint that was missing continues from its last smooth position."""
    missing_joint.must_match("position", per="name")


@check(
    points=5,
    hint="A joint that you don't know yet starts at its position.",
    depends=FILTERS,
    rule="A joint that is new starts at its position: smooth is what arrived.",
)
def test_new_joint(new_joint: Run) -> None:
    """A joint that appears later starts at its position."""
    new_joint.must_match("position", per="name")


@check(
    points=2,
    hint="Create each end once, in __init__, with a plain 10.",
    depends=["test_answers_each_message"],
    rule="Use a queue depth of 10 for both.",
)
def test_quality_of_service(default: Run) -> None:
    """All ends are reliable and volatile, and there is one publisher on each topic."""
    default.must_have_qos()
    for topic in default.exercise.outputs:
        count = len(default.end_points("publisher", topic.name))
        if count != 1:
            fail(f"Publishers on {topic.name}.", expected=1, got=count)
