"""The emergencies of `motor_switch`. Every rule that they rely on is in task.md."""

from __future__ import annotations

from grader.checking import Run, check, fail

MOTORS = "/motors_on"
SUCCESS, CHANGES = ["test_success"], ["test_publishes_each_change"]


@check(
    points=8,
    hint="Remember what the last message on /emergency_stop said.",
    depends=SUCCESS,
    misconception="ignores the emergency stop",
    rule="As long as the emergency stop is pressed, the motors do not switch on: success is false",
)
def test_refuses_in_an_emergency(emergency: Run) -> None:
    """In an emergency it refuses to switch the motors on."""
    run = emergency
    calls = [call for call in run.calls() if call.request["data"]]
    for call in calls[1:]:
        if call.response is None or call.response["success"]:
            text = "the emergency stop is pressed: expected success false."
            run.wrong_at(call.at, text, "request to switch on", "false", "true" if call.response else "no response")


@check(
    points=4,
    hint="The message is 'emergency stop', word for word.",
    depends=["test_refuses_in_an_emergency", "test_message"],
    rule="message is emergency stop.",
)
def test_says_why_it_refuses(emergency: Run) -> None:
    """When it refuses, the message is “emergency stop”."""
    emergency.must_match_responses("message")


@check(
    points=4,
    hint="The emergency stop forbids one thing only.",
    depends=SUCCESS,
    rule="Off is always allowed, even in an emergency.",
)
def test_off_is_always_allowed(emergency: Run) -> None:
    """A request to switch off succeeds, even in an emergency."""
    for call in emergency.calls():
        if not call.request["data"] and not (call.response and call.response["success"]):
            text = "off is always allowed: expected success true."
            got = "false" if call.response else "no response"
            emergency.wrong_at(call.at, text, "request to switch off", "true", got)


@check(
    points=9,
    hint="Switch the motors off in the callback of /emergency_stop.",
    depends=CHANGES,
    misconception="the emergency stop changes nothing",
    rule="Pressed while the motors are on: they go off at once.",
)
def test_emergency_switches_off(emergency: Run) -> None:
    """The emergency stop switches the motors off at once, and they stay off."""
    emergency.must_match_series("data", MOTORS, time=0.06)


@check(
    points=7,
    hint="After the emergency stop, the motors may be switched on again. Releasing it does not switch them on.",
    depends=["test_success", "test_emergency_switches_off"],
    rule="the motors stay as they are, which is off, until somebody asks for them.",
)
def test_released(released: Run) -> None:
    """After the emergency stop has been released, the motors stay off until somebody asks for them."""
    released.must_match_series("data", MOTORS, time=0.06)
    released.must_match_responses("success")


@check(
    points=5,
    hint="Publish changes only: the motors are off already.",
    depends=[*SUCCESS, *CHANGES],
    rule="nothing when a request or an emergency changes nothing.",
)
def test_pressed_while_off(pressed_while_off: Run) -> None:
    """An emergency stop while the motors are off publishes nothing, and prevents switching them on."""
    pressed_while_off.must_match_series("data", MOTORS, time=0.06)
    pressed_while_off.must_match_responses("success")


@check(
    points=5,
    hint="The last message counts, however many there were before.",
    depends=[*SUCCESS, *CHANGES],
    rule="Pressed twice, released twice: that changes nothing. The last message counts.",
)
def test_pressed_twice(pressed_twice: Run) -> None:
    """Pressed twice or released twice is the same as once."""
    pressed_twice.must_match_series("data", MOTORS, time=0.06)
    pressed_twice.must_match_responses("success")


@check(
    points=4,
    hint="The motors are off at the start. There is no change to publish.",
    depends=[*SUCCESS, *CHANGES],
    rule="Nothing at the start, nothing when a request or an emergency changes nothing.",
)
def test_off_at_the_start(off_first: Run) -> None:
    """At the start the motors are off: a request to switch them off changes nothing."""
    off_first.must_match_responses("success")
    off_first.must_match_series("data", MOTORS, time=0.06)


@check(
    points=3,
    hint="Do not wait in the callback.",
    depends=SUCCESS,
    rule="Each request gets one response, at once.",
)
def test_responds_at_once(many: Run) -> None:
    """Each of twenty requests in one second gets its response at once."""
    many.must_respond(within=0.06)


@check(
    points=2,
    hint="Create each end once, in __init__, with a plain 10.",
    depends=["test_responds"],
    rule="Use a queue depth of 10 for both topics.",
)
def test_quality_of_service(switching: Run, released: Run) -> None:
    """All ends are reliable and volatile, and there is one publisher on each topic."""
    for run in (switching, released):
        run.must_have_qos()
        for topic in run.exercise.outputs:
            count = len(run.end_points("publisher", topic.name))
            if count != 1:
                fail(f"Publishers on {topic.name}.", expected=1, got=count)
