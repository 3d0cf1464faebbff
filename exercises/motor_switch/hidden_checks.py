"""The emergencies of `motor_switch`. Every rule that they rely on is in task.md."""

from __future__ import annotations

from collections.abc import Callable

from grader.checking import Run, check, fail
from grader.recording.events import Call

MOTORS = "/motors_on"
RESPONDS = ["test_responds"]


def must_succeed(run: Run, success: bool, which: Callable[[Call], bool], why: str) -> None:
    """Fail unless each of these requests gets a response with this success."""
    for call in run.calls():
        if which(call) and (call.response is None or call.response["success"] is not success):
            word = str(success).lower()
            got = "no response" if call.response is None else str(call.response["success"]).lower()
            part = f"request to switch {'on' if call.request['data'] else 'off'}"
            run.wrong_at(call.at, f"{why}: expected success {word}.", part, word, got)


def changes_between(run: Run, begin: float, end: float, value: bool) -> list[float]:
    """Return when the node published this value on /motors_on between two moments (s)."""
    messages = run.messages_on(MOTORS)
    return [m.at for m in messages if begin <= m.at <= end and m.fields["data"] is value]


@check(
    points=7,
    hint="Remember what the last message on /emergency_stop said.",
    todo="The callback of /emergency_stop stores message.data in an attribute of the node, which __init__ sets "
    "to False. The callback of the service looks at it: if the request is to switch on and the stop is "
    "pressed, success is False, and it returns at once. `emergency = True` without self. is a local "
    "variable, and is forgotten when the callback ends.",
    depends=RESPONDS,
    misconception="ignores the emergency stop",
    rule=("emergency", "stop"),
)
def test_refuses_in_an_emergency(emergency: Run) -> None:
    """In an emergency it refuses to switch the motors on."""
    emergency.must_have_interface("/emergency_stop")
    later = lambda call: call.request["data"] and call.at > 1.0  # noqa: E731
    must_succeed(emergency, False, later, "the emergency stop is pressed")


@check(
    points=6,
    hint="Refuse before you switch.",
    todo="The order counts: first ask whether the request is allowed, and return the refusal if not. Only then "
    "switch and publish. If your node switches first and looks at the emergency afterwards, it says no "
    "and does it all the same, and everybody sees true on /motors_on.",
    depends=RESPONDS,
    rule=("emergency", "stop"),
)
def test_motors_stay_off_in_an_emergency(emergency: Run) -> None:
    """In an emergency the motors do not go on."""
    if on := changes_between(emergency, 1.1, 3.0, True):
        text = "the motors went on, and the emergency stop is pressed: expected nothing."
        emergency.wrong_at(on[0], text, "", "nothing", "true")


@check(
    points=4,
    hint="The message is 'emergency stop', word for word.",
    todo="The response to a refused request has both fields set: success is False, and message is the text of "
    "the task, in small letters, without a full stop. A new response has an empty message. Set it on the "
    "same way on which you set success to False.",
    depends=["test_refuses_in_an_emergency"],
    rule="emergency",
)
def test_says_why_it_refuses(emergency: Run) -> None:
    """When it refuses, the message is “emergency stop”."""
    for call in emergency.calls():
        got = call.response["message"] if call.response else "no response"
        if call.request["data"] and call.at > 1.0 and got != "emergency stop":
            text = f"expected the message “emergency stop”, got “{got}”."
            emergency.wrong_at(call.at, text, "request to switch on", "emergency stop", got)


@check(
    points=3,
    hint="The emergency stop forbids one thing only.",
    todo="Refuse on two conditions together: the stop is pressed, and the request is to switch on. A request "
    "to switch off goes the usual way even in an emergency: success is true, the message says that the "
    "motors are off, and nothing is published if they were off.",
    depends=RESPONDS,
    rule=("off_always", "already"),
)
def test_off_is_always_allowed(emergency: Run) -> None:
    """A request to switch off succeeds, even in an emergency."""
    must_succeed(emergency, True, lambda call: not call.request["data"], "off is always allowed")


@check(
    points=1,
    hint="Which text does a request to switch off get while the stop is pressed? The motors are off then.",
    depends=["test_message", "test_off_is_always_allowed"],
    rule=("says", "off_always"),
)
def test_says_off_in_an_emergency(emergency: Run) -> None:
    """A request to switch off gets the message “motors off”, even in an emergency."""
    for call in emergency.calls():
        got = call.response["message"] if call.response else "no response"
        if not call.request["data"] and got != "motors off":
            text = f"expected the message “motors off”, got “{got}”."
            emergency.wrong_at(call.at, text, "request to switch off", "motors off", got)


@check(
    points=7,
    hint="Switch the motors off in the callback of /emergency_stop.",
    todo="The callback of /emergency_stop has two things to do when data is true: remember it, and switch the "
    "motors off, through the same method as the service, which publishes the change if there is one. Do "
    "it in this callback. A timer or a thread that looks at the attribute is too late.",
    depends=RESPONDS,
    misconception="the emergency stop changes nothing",
    rule=("pressed", "changes", "stop", "motors"),
)
def test_emergency_switches_off(emergency: Run) -> None:
    """The emergency stop switches the motors off at once."""
    emergency.must_have_interface("/emergency_stop", MOTORS)
    if not changes_between(emergency, 1.0, 1.0601, False):
        text = "the emergency stop is pressed while the motors are on: expected false, got nothing."
        emergency.wrong_at(1.0, text, "", "false", "nothing")


@check(
    points=2,
    hint="Does the callback of /emergency_stop publish by itself, or only through the method that switches?",
    depends=["test_publishes_nothing_else"],
    rule=("changes", "nothing_else", "pressed"),
)
def test_publishes_changes_in_an_emergency(
    emergency: Run, released: Run, pressed_while_off: Run, pressed_twice: Run
) -> None:
    """The emergency stop, too, publishes a change once, and nothing if nothing changes."""
    for run in (emergency, released, pressed_while_off, pressed_twice):
        before = None  # whether the motors are off at the start is another check's question
        for message in run.messages_on(MOTORS):
            if message.fields["data"] == before:
                state, word = "on" if before else "off", str(before).lower()
                text = f"{word} was published, and the motors were {state} already: expected nothing."
                run.wrong_at(message.at, text, "", "nothing", word)
            before = message.fields["data"]


@check(
    points=5,
    hint="Releasing the emergency stop changes no motor. Afterwards, the motors may be switched on again.",
    todo="When the stop is released, remember that, and do nothing else. Keep no wish: neither the state "
    "before the emergency nor a request that was refused may be carried out now. Afterwards, a request to "
    "switch on works as usual. If it is still refused, the attribute does not become False: look at how "
    "the callback handles data == False.",
    depends=RESPONDS,
    rule=("released", "pressed", "changes"),
)
def test_released(released: Run) -> None:
    """After the emergency stop has been released, the motors stay off until somebody asks for them."""
    if early := changes_between(released, 1.1, 2.4, True):
        text = "the motors went on when the emergency stop was released: expected nothing."
        released.wrong_at(early[0], text, "", "nothing", "true")
    must_succeed(released, True, lambda call: call.at > 2.0, "the emergency stop is released")
    if not changes_between(released, 2.4, 2.6, True):
        released.wrong_at(2.5, "the motors go on: expected true, got nothing.", "", "true", "nothing")


@check(
    points=4,
    hint="The emergency stop is pressed, whether the motors were on or not.",
    todo="Remember the stop in any case, before you look at the motors. If the attribute is only set inside an "
    "`if` that asks whether the motors are on, a stop that is pressed while they are off is never "
    "noticed, and the next request switches them on.",
    depends=RESPONDS,
    rule=("emergency", "released"),
)
def test_pressed_while_off(pressed_while_off: Run) -> None:
    """An emergency stop while the motors are off prevents switching them on, until it is released."""
    pressed_while_off.must_match_responses("success")
    if early := changes_between(pressed_while_off, 1.4, 1.9, True):
        text = "the motors went on when the emergency stop was released, and the request had been refused."
        pressed_while_off.wrong_at(early[0], f"{text} Expected nothing.", "", "nothing", "true")


@check(
    points=5,
    hint="The last message counts, however many there were before.",
    todo="Store what the message says, instead of counting presses, or turning "
    "the attribute round with `not`. Two messages that say the same then have the same effect as one. The "
    "motors are off already, so the second press publishes nothing.",
    depends=RESPONDS,
    rule=("twice", "emergency", "released", "changes"),
)
def test_pressed_twice(pressed_twice: Run) -> None:
    """Pressed twice or released twice is the same as once."""
    if off := changes_between(pressed_twice, 0.6, 0.95, False):
        text = "the emergency stop was released, and had not been pressed: expected nothing."
        pressed_twice.wrong_at(off[0], text, "", "nothing", "false")
    must_succeed(pressed_twice, False, lambda call: 1.3 < call.at < 1.5, "the emergency stop is pressed")
    must_succeed(pressed_twice, True, lambda call: 1.7 < call.at < 1.9, "the emergency stop is released")


@check(
    points=3,
    hint="The motors are off at the start. There is no change to publish.",
    depends=RESPONDS,
    rule=("start", "already", "nothing_else"),
)
def test_off_at_the_start(off_first: Run) -> None:
    """At the start the motors are off: a request to switch them off succeeds, and changes nothing."""
    must_succeed(off_first, True, lambda call: True, "nothing forbids it")
    if off := changes_between(off_first, 0.0, 0.9, False):
        off_first.wrong_at(off[0], "the motors were off already: expected nothing.", "", "nothing", "false")


@check(
    points=3,
    hint="Do not wait in the callback.",
    depends=RESPONDS,
    rule=("respond", "wait"),
)
def test_responds_at_once(many: Run) -> None:
    """Each of twenty requests in one second gets its response at once."""
    many.must_respond(within=0.06)


@check(
    points=1,
    hint="Create each end once, in __init__, with a plain 10.",
    depends=RESPONDS,
    rule="queue",
)
def test_quality_of_service(switching: Run, released: Run) -> None:
    """All ends are reliable and volatile with a depth of 10, and there is one publisher on each topic."""
    for run in (switching, released):
        run.must_have_qos(depth=True)
        for topic in run.exercise.outputs:
            count = len(run.end_points("publisher", topic.name))
            if count != 1:
                fail(f"Publishers on {topic.name}.", expected=1, got=count)
