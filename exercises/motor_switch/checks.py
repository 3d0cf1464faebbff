"""What every student may read: the checks of `motor_switch`.

Each fixture is a scenario of scenarios.py; hidden_checks.py goes through the emergencies.
"""

from __future__ import annotations

from collections.abc import Callable

from grader.checking import Run, Wrong, check, each
from grader.recording.recording import ReceivedMessage

MOTORS = "/motors_on"


def must_publish_the_changes(run: Run) -> None:
    """Fail unless each change that the solution publishes is published, too, at that time."""
    published = run.messages_on(MOTORS)

    def judge(change: ReceivedMessage) -> None:
        value = change.fields["data"]
        soon = [m for m in published if abs(m.at - change.at) <= 0.060001]
        if not any(message.fields["data"] == value for message in soon):
            got = str(soon[0].fields["data"]).lower() if soon else "nothing"
            word = str(value).lower()
            text = f"the motors are switched: expected {word} on {MOTORS}, got {got}."
            run.wrong_at(change.at, text, "", word, got)

    each(run.messages_on(MOTORS, reference=True), judge)


def must_alternate(run: Run) -> None:
    """Fail unless each message is a change, and the first says that the motors are on."""
    before = False
    for message in run.messages_on(MOTORS):
        if message.fields["data"] == before:
            word = str(before).lower()
            text = f"{word} was published, and the motors were {'on' if before else 'off'} before: expected nothing."
            run.wrong_at(message.at, text, "", "nothing", word)
        before = message.fields["data"]


def share(judge: Callable[[Run], None], run: Run) -> float:
    """Return how much of a run is right by a function that fails otherwise."""
    try:
        judge(run)
    except Wrong as wrong:
        return wrong.share
    return 1.0


@check(
    points=6,
    hint="Create the service in __init__. Its callback fills in the response and returns it.",
    todo="create_service(SetBool, '/switch_motors', self.on_request) in __init__ makes the service. Its "
    "callback gets the request and an empty response. It fills in both fields, success and message, and "
    "ends with `return response`, on each way through it: without that, the client gets no answer. The "
    "topics need a publisher and a subscription in __init__, too. Try it: `ros2 service call "
    '/switch_motors std_srvs/srv/SetBool "{data: true}"`.',
    rule="service",
    partial=True,
)
def test_responds(switching: Run) -> None:
    """It has the service /switch_motors, and its messages or what it publishes are mostly right."""
    switching.must_have_interface("/switch_motors")
    switching.must_respond()
    messages = share(lambda run: run.must_match_responses("message"), switching)
    if max(messages, share(must_publish_the_changes, switching)) <= 0.5:
        switching.must_match_responses("message")


@check(
    points=8,
    hint="response.success says whether the request was carried out.",
    todo="success says whether the motors are now as the request wants them. A new response has success = "
    "False, so set it to True on each way on which the request is carried out, also on that to switch "
    "off, and if there was nothing to do. It is not the state of the motors: a request to switch off that "
    "is carried out has success true.",
    depends=[test_responds],
    rule=("says", "request"),
    partial=True,
)
def test_success(switching: Run) -> None:
    """success is true when the motors are as requested."""
    switching.must_match_responses("success")


@check(
    points=8,
    hint="Is message made after the motors are switched, and from their state?",
    todo="The callback does three things, in this order: it decides whether the request may be carried out, it "
    "switches the motors (and publishes, if that is a change), and it fills in the response. So message says "
    "how the motors are now, not how they were, and not what was asked for. Keep the state in one attribute "
    "of the node, and make the text from it in one place. Try it: `ros2 service call /switch_motors "
    'std_srvs/srv/SetBool "{data: true}"`.',
    depends=[test_responds],
    misconception="the state before the request",
    rule=("says", "request"),
    partial=True,
)
def test_message(switching: Run) -> None:
    """message gives the state of the motors after the request."""
    switching.must_match_responses("message")


@check(
    points=9,
    hint="Publish at the moment when the motors are switched.",
    todo="Keep the state of the motors in one attribute, and change it in one method only. Let this method "
    "publish the new state, right after the change. Then each change is published, whoever asked for it. "
    "Make a new Bool with the new state as its data: if you publish before you change the attribute, it "
    "is the old one.",
    depends=[test_responds],
    rule=("changes", "start", "request", "motors"),
    partial=True,
)
def test_publishes_each_change(switching: Run) -> None:
    """It publishes true when the motors go on, and false when they go off."""
    switching.must_have_interface(MOTORS)
    must_publish_the_changes(switching)


@check(
    points=6,
    hint="Publish only if the motors were in the other state before.",
    todo="Compare before you switch: if the motors already are as they should be, there is no change, and "
    "nothing is published. Do that in the method that switches, so that it holds for requests and for the "
    "emergency stop. Publish nothing in __init__ and nothing from a timer: nobody has switched anything "
    "there.",
    depends=[test_responds],
    rule=("nothing_else", "start", "motors"),
)
def test_publishes_nothing_else(switching: Run, already: Run) -> None:
    """It publishes changes only, each once, and nothing at the start."""
    switching.must_have_interface(MOTORS)
    for run in (switching, already):
        must_alternate(run)


@check(
    points=6,
    hint="success is true in either case, and message is the state.",
    todo="A request to switch on what is on already is no mistake. Answer as if the motors had just been "
    "switched: success is true, and the message says how they are. The only difference is that nothing is "
    "published. Look for an `if` that sets success to False, or that leaves the response empty.",
    depends=[test_responds],
    rule=("already", "says", "request"),
)
def test_nothing_to_do(already: Run) -> None:
    """When the motors are already as requested, it gives the same answer."""
    already.must_match_responses()


@check(
    points=3,
    hint="super().__init__('motor_switch')",
    depends=[test_responds],
    rule=("node", "other_topics"),
)
def test_node_is_called_motor_switch(switching: Run) -> None:
    """There is one node, it is called motor_switch, and it publishes on no other topics."""
    switching.must_have_nodes()
    switching.must_publish_on_no_others()


@check(
    points=3,
    hint="Catch KeyboardInterrupt and ExternalShutdownException around rclpy.spin, then call rclpy.try_shutdown().",
    depends=[test_responds],
    rule="ctrl_c",
)
def test_ends_on_ctrl_c(switching: Run) -> None:
    """On Ctrl-C it ends within 2 s, with no traceback."""
    switching.must_end_on_ctrl_c()
