"""The harder scenarios of `calibration`. Every rule that they rely on is in task.md."""

from __future__ import annotations

from checks import OFFSETS, PENDING, must_count

from grader.checking import Run, check, fail

ASKS, OFFSET, COUNT = ["test_asks"], ["test_publishes_the_offset"], ["test_number_of_pending"]


def must_ask_in_time(run: Run, within: float, seconds: dict[str, float]) -> None:
    """Fail unless the request for each joint goes out within so many seconds after `seconds`."""
    run.must_match_requests("joint")
    for call in run.calls(by="node"):
        joint = call.request["joint"]
        late = call.at - seconds[joint]
        if late > within + 1e-9:
            text = f"the request for {joint} was expected within {within:g} s, got it {late:.2f} s later."
            run.wrong_at(call.at, text, "", f"within {within:g} s", f"after {late:.2f} s")


@check(
    points=5,
    hint="Never wait in a callback, neither for the service nor for its answer.",
    todo="Find the line at which your node waits when the service is not there, or when it never answers. "
    "wait_for_service() and call() both wait, and so does a while loop around service_is_ready(). Ask "
    "service_is_ready() once and return if the answer is no; the timer asks again. Send requests with "
    "call_async(), and take the answer in a done-callback. Then every callback ends at once, and the "
    "timer fires every 0.1 s.",
    depends=ASKS,
    misconception="waits for the service",
    rule=("never_stop", "never_wait", "count_topic"),
)
def test_never_silent(absent: Run, never: Run) -> None:
    """/calibrations_pending continues when the service is not there, and when it never answers."""
    for run in (absent, never):
        run.must_publish(PENDING)
        run.must_have_no_gap(0.6, PENDING)


@check(
    points=5,
    hint="Each call_async() has a future of its own. Do not wait for one before the next.",
    todo="Send the request in the callback of /calibrate, without looking at whether another one is under way. "
    "Each call_async() returns a future of its own, and many can be open at once. If you keep one future "
    "in one attribute, the next request replaces it: use a dictionary, from the future to the joint and "
    "the time of its request, or a small object for each request.",
    depends=ASKS,
    misconception="one after another",
    rule=("parallel", "ask", "never_wait"),
)
def test_asks_at_once(several: Run) -> None:
    """It asks for each joint at once, even while others are being calibrated."""
    must_ask_in_time(several, 0.15, {message.data: message.at for message in several.sent})


@check(
    points=3,
    hint="Each message on /calibrate is a request, whatever joint it names.",
    depends=ASKS,
    rule=("ask", "pending"),
)
def test_same_joint_again(again: Run) -> None:
    """It asks for a joint a second time when it is named a second time, and counts it twice meanwhile."""
    again.must_match_requests("joint")
    must_count(again)


@check(
    points=2,
    hint="0.0 is an offset like any other. Look at success.",
    depends=OFFSET,
    rule=("success", "offsets"),
)
def test_offset_of_zero(again: Run) -> None:
    """An offset of 0.0 is published, too."""
    if [0.0] not in [message.fields["position"][-1:] for message in again.messages_on(OFFSETS)]:
        calls = again.calls(by="node")
        if len(calls) > 1:
            again.wrong_at(calls[1].answered, "expected an offset of 0.0, got nothing.", "", "0.0", "nothing")


@check(
    points=5,
    hint="The done-callback has to know to which joint its future belongs.",
    todo="The answers come in any order, so neither the last joint that was named nor the first of a list is "
    "the one that was answered. Bind the name to its own future when you send the request: "
    "add_done_callback(functools.partial(self.on_answer, joint)). A lambda that only uses the variable "
    "`joint` of a loop reads it later, when it has another value: write `lambda future, joint=joint: …`.",
    depends=["test_publishes_the_name"],
    misconception="mixes joints up",
    rule=("order", "success", "offsets"),
)
def test_answers_in_another_order(several: Run, appears: Run) -> None:
    """Each offset is published with the name of its own joint, whatever the order of the answers."""
    several.must_publish(OFFSETS, count=5)
    for run in (several, appears):
        offsets = {call.request["joint"]: call.response["offset"] for call in run.calls(by="node") if call.response}
        run.must_publish(OFFSETS, count=len(offsets))
        for message in run.messages_on(OFFSETS):
            got = dict(zip(message.fields["name"], message.fields["position"], strict=False))
            if len(got) != 1 or not got.items() <= offsets.items():
                text = f"expected the offset of one joint, one of {offsets}, got {got}."
                run.wrong_at(message.at, text, "", f"one of {offsets}", got)


@check(
    points=4,
    hint="Look at success before you publish.",
    todo="The response has a field success. If it is false, the field offset means nothing, whatever it holds. "
    "Check success first in the done-callback, and return without publishing. The joint is no longer "
    "waiting, though: an answer came. So take it off the list before you look at success.",
    depends=OFFSET,
    misconception="ignores success",
    rule="failure",
)
def test_failed_calibration(failing: Run) -> None:
    """When a calibration has failed, it publishes no offset."""
    failing.must_publish(OFFSETS, count=2)


@check(
    points=3,
    hint="A response with success false is an answer, too.",
    depends=COUNT,
    rule=("not_waiting", "parallel"),
)
def test_failed_is_not_pending(failing: Run) -> None:
    """A joint whose calibration failed is no longer pending."""
    must_count(failing)


@check(
    points=3,
    hint="Use math.isfinite(offset).",
    depends=OFFSET,
    rule="finite",
)
def test_offset_that_is_no_number(not_finite: Run) -> None:
    """An offset that is not a number or infinite is not published."""
    not_finite.must_publish(OFFSETS, count=1)


@check(
    points=5,
    hint="service_is_ready() says whether the service is there. Ask again in the timer.",
    todo="service_is_ready() says at once whether the service is there, without waiting. In the callback of "
    "/calibrate, put the name at the end of a list. In a method of its own, send a request for each name "
    "of the list, the oldest first, as long as the service is ready. Call this method from the callback "
    "and from the timer: the timer notices within 0.1 s that the service has appeared.",
    depends=ASKS,
    misconception="asks without a service",
    rule=("keep", "parallel", "never_wait"),
)
def test_service_appears_late(appears: Run) -> None:
    """When the service appears late, it asks for all joints that were waiting."""
    must_ask_in_time(appears, 0.2, dict.fromkeys(("left_elbow", "left_shoulder_roll", "left_shoulder_pitch"), 2.02))


@check(
    points=2,
    hint="A joint for which you could not ask yet waits without a limit.",
    depends=ASKS,
    rule="keep",
)
def test_service_appears_very_late(appears_very_late: Run) -> None:
    """It keeps a joint until the service appears, however long that takes."""
    must_ask_in_time(appears_very_late, 0.2, {"left_elbow": 6.02})


@check(
    points=2,
    hint="The 5 s begin with the request, not with the message on /calibrate.",
    depends=["test_publishes_the_offset", "test_service_appears_very_late"],
    rule="give_up",
)
def test_five_seconds_from_the_request(appears_very_late: Run) -> None:
    """It waits for the answer for 5 s after the request, even if the joint had to wait before that."""
    appears_very_late.must_publish(OFFSETS, count=1)


@check(
    points=3,
    hint="Joints that you could not ask for yet are pending, too.",
    depends=COUNT,
    rule=("pending", "keep"),
)
def test_pending_without_a_service(absent: Run) -> None:
    """Joints that wait for the service are pending."""
    must_count(absent)


@check(
    points=4,
    hint="Remember when each request went out, and check the time in the timer.",
    todo="When you send a request, keep the node's time along with its future: self.get_clock().now(). In the "
    "timer, look at each request that has no answer, and forget those whose time is 5 s ago or more: "
    "compare the difference with Duration(seconds=5.0). Do not start the 5 s when the message arrives, "
    "because the service may not be there yet, and do not use time.time().",
    depends=COUNT,
    misconception="waits forever",
    rule=("give_up", "not_waiting", "clock", "parallel"),
)
def test_gives_up(never: Run) -> None:
    """After 5 s without an answer it gives up: the joint is no longer pending."""
    must_count(never)


@check(
    points=3,
    hint="The 5 s go by the node's clock.",
    depends=OFFSET,
    misconception="gives up too early",
    rule=("give_up", "clock"),
)
def test_slow_answer(slow: Run) -> None:
    """An answer after 4.5 s still counts."""
    slow.must_publish(OFFSETS, count=1)


@check(
    points=3,
    hint="Forget the future when you give up.",
    todo="A future whose joint was given up is still alive, and calls its done-callback when the late answer "
    "comes. So the callback must first look at whether this very future is still among those that you "
    "wait for, and return if not. The name of the joint is not enough: somebody may have asked for the "
    "same joint again meanwhile.",
    depends=[*OFFSET, "test_gives_up"],
    rule="late",
)
def test_answer_that_is_too_late(too_late: Run) -> None:
    """An answer that arrives after it gave up is ignored."""
    for message in too_late.messages_on(OFFSETS):
        if message.at > 6.0 and 0.01 in message.position:
            text = "this answer came 5.6 s after its request: expected nothing, got its offset."
            too_late.wrong_at(message.at, text, "", "nothing", "an offset of 0.01 rad")
    must_count(too_late)


@check(
    points=1,
    hint="Create each end once, in __init__, with a plain 10.",
    depends=ASKS,
    rule="queue",
)
def test_quality_of_service(one: Run) -> None:
    """All ends are reliable and volatile with a depth of 10, and there is one publisher on each topic."""
    one.must_have_qos(depth=True)
    for topic in one.exercise.outputs:
        count = len(one.end_points("publisher", topic.name))
        if count != 1:
            fail(f"Publishers on {topic.name}.", expected=1, got=count)
