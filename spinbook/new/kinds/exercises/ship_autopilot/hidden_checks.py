"""Checks that students may not read: the rest of `ship_autopilot`. Every rule that they rely on is in task.md."""

from __future__ import annotations

import math

from grader.checking import Run, check

ANSWERS = ["test_answers_each_heading"]
LEFT = ["test_reaches_a_course_to_the_left"]
RIGHT = ["test_reaches_a_course_to_the_right"]
TURNS = ["test_turns_towards_the_course"]


@check(
    points=2,
    hint="Put the rudder amidships when the ship is on its course.",
    depends=TURNS,
    rule="12 s after a course was given, the ship heads within 0.05 rad of it, and stays there.",
)
def test_reaches_a_course_to_the_left(left: Run) -> None:
    """It reaches a course to the left, and stays there."""
    left.must_reach("/turned", {"data": 1.0}, tolerance=0.05, within=12.0, start=1.05)


@check(
    points=1,
    hint="A negative rudder turns the ship to the right.",
    depends=LEFT,
    rule="12 s after a course was given, the ship heads within 0.05 rad of it, and stays there.",
)
def test_reaches_a_course_to_the_right(right: Run) -> None:
    """It reaches a course to the right, and stays there."""
    right.must_reach("/turned", {"data": -1.0}, tolerance=0.05, within=12.0, start=1.05)


@check(
    points=1,
    hint="A smaller gain turns more gently.",
    depends=RIGHT,
    misconception="a gain that is too large",
    rule="The ship swings past its course by 0.01 rad at most.",
)
def test_does_not_overshoot(left: Run, right: Run) -> None:
    """The ship does not swing past its course."""
    left.must_reach("/turned", {"data": 1.0}, tolerance=0.05, within=12.0, overshoot=0.01, start=1.05)
    right.must_reach("/turned", {"data": -1.0}, tolerance=0.05, within=12.0, overshoot=0.01, start=1.05)


@check(
    points=3,
    hint="Bring the difference of the angles between -pi and pi, not the angles.",
    depends=LEFT,
    misconception="wraps the angle and not the difference",
    rule="From 3.0 rad to −3.0 rad it is 0.28 rad through π, and not 6 rad back through 0.",
)
def test_turns_the_short_way_round(across: Run) -> None:
    """It turns the shorter way, through pi."""
    across.must_reach("/turned", {"data": 2 * math.pi - 6.0}, tolerance=0.05, within=12.0, overshoot=0.01, start=1.05)


@check(
    points=1,
    hint="The rudder may stay at its limit for a while.",
    depends=RIGHT,
    rule="For half a turn it has 20 s.",
)
def test_half_a_turn(about: Run) -> None:
    """It makes half a turn."""
    about.must_reach("/turned", {"data": -3.1}, tolerance=0.05, within=20.0, overshoot=0.01, start=1.05)


@check(
    points=1,
    hint="Bring the difference of the angles between -pi and pi, however large it is.",
    depends=LEFT,
    rule="A course may be any angle, also beyond π: 7.0 rad is the same as 0.717 rad.",
)
def test_a_course_beyond_two_pi(beyond: Run) -> None:
    """A course beyond two pi is the same as one turn less."""
    beyond.must_reach("/turned", {"data": 7.0 - 2 * math.pi}, tolerance=0.05, within=12.0, overshoot=0.01, start=1.05)


@check(
    points=1,
    hint="Remember the latest course.",
    depends=RIGHT,
    rule="A new course replaces the old one at any time.",
)
def test_a_new_course(two_courses: Run) -> None:
    """A second course replaces the first."""
    two_courses.must_reach("/turned", {"data": -0.5}, tolerance=0.05, within=12.0, start=16.05)


@check(
    points=1,
    hint="max(-0.6, min(0.6, …)).",
    depends=ANSWERS,
    rule="The rudder goes from −0.6 to 0.6 rad.",
)
def test_rudder_within_its_limits(left: Run, about: Run) -> None:
    """The rudder stays between -0.6 and 0.6 rad."""
    for run in (left, about):
        for one in run.messages_on("/rudder"):
            if not abs(one.fields["data"]) <= 0.6 + 1e-6:
                text = f"the rudder goes to 0.6 rad at most, got {one.fields['data']:.3g} rad."
                run.wrong_at(one.at, text, "/rudder", "at most 0.6 rad", one.fields["data"])


@check(
    points=1,
    hint="Before the first course there is nothing to steer to.",
    depends=ANSWERS,
    rule="Without a course the rudder is amidships: 0.0.",
)
def test_amidships_without_a_course(adrift: Run) -> None:
    """Without a course the rudder is amidships."""
    adrift.must_match_series("data", topic="/rudder")


@check(
    points=1,
    hint="Compare the names and the queue depths in __init__ with the task.",
    depends=ANSWERS,
    rule="Its node is called ship_autopilot.",
)
def test_node_is_as_described(bench: Run) -> None:
    """The node has the name and the quality of service of the task."""
    bench.must_be_as_declared()
