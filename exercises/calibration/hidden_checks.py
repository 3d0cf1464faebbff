"""The harder scenarios of `calibration`. Every rule that they rely on is in task.md."""

from __future__ import annotations

from grader.checking import Run, check, fail

OFFSETS, PENDING = "/joint_offsets", "/calibrations_pending"
OFFSET, COUNT, RATE = ["test_publishes_the_offset"], ["test_number_of_pending"], ["test_ten_times_a_second"]


def must_ask_in_time(run: Run, within: float, seconds: dict[str, float]) -> None:
    """Fail unless the request for each joint goes out within so many seconds after `seconds`."""
    run.must_match_requests("joint")
    for call in run.calls(by="node"):
        joint = call.request["joint"]
        late = (call.at - 100_000_000_000) / 1_000_000_000 - seconds[joint]
        if late > within + 1e-9:
            text = f"the request for {joint} was expected within {within:g} s, got it {late:.2f} s later."
            run.wrong_at(call.at, text, "", f"within {within:g} s", f"after {late:.2f} s")


@check(
    points=8,
    hint="Never wait in a callback, neither for the service nor for its answer.",
    depends=RATE,
    misconception="waits for the service",
    rule="Never stop, whatever the service does.",
)
def test_never_silent(absent: Run, never: Run) -> None:
    """/calibrations_pending continues when the service is not there, and when it never answers."""
    for run in (absent, never):
        run.must_have_no_gap(0.15, PENDING)


@check(
    points=6,
    hint="Each call_async() has a future of its own. Do not wait for one before the next.",
    depends=["test_asks"],
    misconception="one after another",
    rule="Do not wait for one answer before the next request.",
)
def test_asks_at_once(several: Run) -> None:
    """It asks for each joint at once, even while others are being calibrated."""
    joints = {"left_elbow": 0.55, "left_shoulder_roll": 0.65, "left_shoulder_pitch": 0.75}
    must_ask_in_time(several, 0.15, joints)


@check(
    points=7,
    hint="The done-callback has to know to which joint its future belongs.",
    depends=["test_asks_at_once", "test_publishes_the_name"],
    misconception="mixes joints up",
    rule="Answers may come in a different order.",
)
def test_answers_in_another_order(several: Run) -> None:
    """Each offset is published with the name of its own joint, whatever the order of the answers."""
    several.must_match_series("name", OFFSETS)
    several.must_match_series("position", OFFSETS)


@check(
    points=5,
    hint="Look at success before you publish.",
    depends=["test_publishes_the_name"],
    misconception="ignores success",
    rule="publish nothing on /joint_offsets.",
)
def test_failed_calibration(failing: Run) -> None:
    """When a calibration has failed, it publishes no offset."""
    failing.must_match_series("name", OFFSETS)


@check(
    points=4,
    hint="A response with success false is an answer, too.",
    depends=COUNT,
    rule="A joint that failed or timed out is no longer waiting.",
)
def test_failed_is_not_pending(failing: Run) -> None:
    """A joint whose calibration failed is no longer pending."""
    failing.must_match_series("data", PENDING)


@check(
    points=4,
    hint="Use math.isfinite(offset).",
    depends=["test_publishes_the_name"],
    rule="An offset that is not a number or infinite counts as no success.",
)
def test_offset_that_is_no_number(not_finite: Run) -> None:
    """An offset that is not a number or infinite is not published."""
    not_finite.must_match_series("name", OFFSETS)


@check(
    points=5,
    hint="service_is_ready() says whether the service is there. Ask again in the timer.",
    depends=["test_asks"],
    misconception="asks without a service",
    rule="Keep the joints, and ask for them in their order within 0.2 s after it appears.",
)
def test_service_appears_late(appears: Run) -> None:
    """When the service appears late, it asks for all joints that were waiting."""
    must_ask_in_time(appears, 0.2, dict.fromkeys(("left_elbow", "left_shoulder_roll", "left_shoulder_pitch"), 2.02))


@check(
    points=3,
    hint="Joints that you could not ask for yet are pending, too.",
    depends=COUNT,
    rule="those that you could not ask for yet, and those that have no answer yet.",
)
def test_pending_without_a_service(absent: Run) -> None:
    """Joints that wait for the service are pending."""
    absent.must_match_series("data", PENDING)


@check(
    points=5,
    hint="Remember when each request went out, and check the time in the timer.",
    depends=COUNT,
    misconception="waits forever",
    rule="No answer 5 s after the request: give up.",
)
def test_gives_up(never: Run) -> None:
    """After 5 s without an answer it gives up: the joint is no longer pending."""
    never.must_match_series("data", PENDING)


@check(
    points=4,
    hint="Forget the future when you give up.",
    depends=["test_publishes_the_name", "test_gives_up"],
    rule="An answer that arrives later is ignored.",
)
def test_answer_that_is_too_late(too_late: Run) -> None:
    """An answer that arrives after it gave up is ignored."""
    too_late.must_match_series("name", OFFSETS)


@check(
    points=2,
    hint="Create each end once, in __init__, with a plain 10.",
    depends=["test_asks"],
    rule="Use a queue depth of 10 for all topics.",
)
def test_quality_of_service(one: Run) -> None:
    """All ends are reliable and volatile, and there is one publisher on each topic."""
    one.must_have_qos()
    for topic in one.exercise.outputs:
        count = len(one.end_points("publisher", topic.name))
        if count != 1:
            fail(f"Publishers on {topic.name}.", expected=1, got=count)
