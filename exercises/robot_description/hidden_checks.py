"""The harder scenarios of `robot_description`. Every rule that they rely on is in task.md."""

from __future__ import annotations

from grader.checking import Run, check

NAMED = "test_node_is_called_robot_description"
ONCE, START = ["test_publishes_once"], ["test_description_of_the_start", NAMED]


@check(
    points=5,
    hint="A post-set callback sees the new value; an on-set callback does not.",
    depends=[*ONCE, *START],
    misconception="publishes the former text",
    rule="When the parameter changes, publish the new text, once, within 0.1 s.",
)
def test_description_that_changes(changed: Run) -> None:
    """When the parameter changes, the new description is published."""
    changed.must_match_series(time=0.1)


@check(
    points=3,
    hint="The depth is how many messages the publisher keeps for late subscribers.",
    depends=["test_late_subscriber", "test_description_that_changes"],
    rule="A late subscriber gets the newest description, once, and no older one.",
)
def test_late_subscriber_gets_the_newest(changed: Run) -> None:
    """Late subscribers get the newest description, and no older one."""
    changed.must_match_series(subscriber="late at 1.6 s")


@check(
    points=2,
    hint="Compare with the text that was published last.",
    depends=["test_description_that_changes"],
    rule="not when the parameter is set to the text that it already has.",
)
def test_same_text_again(same: Run) -> None:
    """Nothing is published when the parameter is set to the text that it already has."""
    same.must_match_series()


@check(
    points=3,
    hint="Try to read the text as XML before you accept it.",
    depends=["test_description_that_changes"],
    misconception="takes every text",
    rule="Refused: a text that is not well-formed XML, and XML whose outermost element is not robot.",
)
def test_refuses_what_is_no_robot(refused: Run) -> None:
    """It refuses texts that are not XML, and XML that is not about a robot."""
    refused.must_refuse("robot_description")


@check(
    points=1,
    hint="SetParametersResult has a field for the reason.",
    depends=["test_refuses_what_is_no_robot"],
    rule="The parameter stays as it was, nothing is published, and the refusal has a reason.",
)
def test_refuses_with_a_reason(refused: Run) -> None:
    """Each refusal has a reason."""
    for change in refused.recording.parameters:
        if change.taken is False and not change.reason:
            refused.wrong_at(change.at, "a text was refused without a reason.", "", "a reason", "none")


@check(
    points=1,
    hint="Publish in the post-set callback, not in the on-set callback.",
    depends=["test_description_that_changes"],
    rule="The parameter stays as it was, nothing is published, and the refusal has a reason.",
)
def test_publishes_nothing_refused(refused: Run) -> None:
    """Nothing is published when a text is refused."""
    refused.must_match_series()


@check(
    points=1,
    hint="An exception in a callback ends the node.",
    depends=["test_description_that_changes"],
    rule="It continues to run, and accepts the next valid one.",
)
def test_goes_on_after_a_bad_text(after_refusal: Run) -> None:
    """After an invalid text, it accepts the next valid one."""
    after_refusal.must_take("robot_description", after_refusal.recording.parameters[1].value)
