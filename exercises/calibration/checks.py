"""What every student may read: the checks of `calibration`.

Each fixture is a scenario of scenarios.py; hidden_checks.py goes through the harder ones.
"""

from __future__ import annotations

from grader.checking import Run, check, each
from grader.recording.recording import ReceivedMessage

OFFSETS, PENDING = "/joint_offsets", "/calibrations_pending"

#: In ns: how long a request may go unanswered, and by how much times may differ.
GIVE_UP, TOLERANCE = 5_000_000_000, 150_000_001


def must_count(run: Run) -> None:
    """Fail unless each number on /calibrations_pending is right for the node's own requests, within 0.15 s.

    A joint waits from its message until its request was answered, or for 5 s after it.
    """
    begins = [message.at_ns for message in run.sent]
    ends = [min(call.answered_ns or call.at_ns + GIVE_UP, call.at_ns + GIVE_UP) for call in run.calls(by="node")]

    def waiting(at: int) -> int:
        return max(0, sum(begin <= at for begin in begins) - sum(end <= at for end in ends))

    def judge(message: ReceivedMessage) -> None:
        first, last = message.at_ns - TOLERANCE, message.at_ns + TOLERANCE
        right = {waiting(at) for at in (first, last, *(at for at in begins + ends if first <= at <= last))}
        if message.fields["data"] not in right:
            got, words = message.fields["data"], " or ".join(map(str, sorted(right)))
            run.wrong_at(message.at, f"expected {words} on {PENDING}, got {got}.", "", words, got)

    run.must_publish(PENDING)
    each(run.messages_on(PENDING), judge)


@check(
    points=8,
    hint="Call call_async() in the callback of /calibrate, with the joint's name in the request.",
    todo="A client needs three things: self.create_client(CalibrateJoint, '/calibrate_joint') in __init__, a "
    "Request with the joint's name in its field joint, and call_async(request). The callback of "
    "/calibrate gets a String: the name is in its field data. Make a new Request for each message, send "
    "it and return. Log the name just before you send it. If the line never appears, the callback is not "
    "called, or a condition before the call is false.",
    rule=("input", "service"),
)
def test_asks(one: Run) -> None:
    """It calls /calibrate_joint with the name of the joint that it received on /calibrate."""
    one.must_have_interface("/calibrate", "/calibrate_joint")
    one.must_match_requests("joint")


@check(
    points=10,
    hint="Use future.add_done_callback(…), and publish the offset in that callback.",
    todo="call_async() returns a future, and the answer is in it later. Give the future a method with "
    "add_done_callback(): the method is called with the future as soon as the answer is there, and "
    "future.result() is the response. Check success there, make a JointState with the joint's name and "
    "the offset, and publish it in this method. Do not wait in the callback of /calibrate: while it "
    "waits, the answer can't arrive.",
    depends=[test_asks],
    rule=("success", "never_wait", "offsets"),
)
def test_publishes_the_offset(one: Run) -> None:
    """When the answer comes, it publishes the offset on /joint_offsets."""
    one.must_have_interface(OFFSETS)
    one.must_match_series("position", OFFSETS)
    for call, message in zip(one.calls(by="node"), one.messages_on(OFFSETS), strict=False):
        late = round(message.at - (call.answered or message.at), 6)
        if abs(late) > 0.15:
            text = f"it was expected when the answer came, got it {late:.2f} s later."
            one.wrong_at(message.at, text, "", "with the answer", f"{late:.2f} s later")


@check(
    points=5,
    hint="name and position are lists, with one element each.",
    todo="A JointState describes joints by two lists that belong together: name[0] is the joint to which "
    "position[0] belongs. The response does not repeat the name, so your node has to remember for which "
    "joint it asked. Let the done-callback get the name along with the future, with functools.partial or "
    "as a default argument of a lambda, and put it into a list: ['left_elbow'], not 'left_elbow'.",
    depends=[test_publishes_the_offset],
    rule=("success", "offsets"),
)
def test_publishes_the_name(one: Run) -> None:
    """The message on /joint_offsets has the joint's name."""
    one.must_match_series("name", OFFSETS)


@check(
    points=10,
    hint="Use a timer. It works as long as no callback waits.",
    todo="A timer that is created in __init__ with a period of 0.1 s calls a method ten times per second, by "
    "the node's clock. Publish in this method and nowhere else, also when nobody waits: then the number "
    "is 0. If there are gaps, some callback waits. Look for call(), wait_for_service(), "
    "spin_until_future_complete(), time.sleep() and loops: while one of them runs, the timer can't.",
    depends=[test_asks],
    misconception="waits for the answer",
    rule=("pending", "never_wait", "never_stop", "count_topic"),
)
def test_ten_times_a_second(one: Run) -> None:
    """It publishes on /calibrations_pending ten times per second, even while it waits for an answer."""
    one.must_have_interface(PENDING)
    one.must_keep_rate(10.0, PENDING)
    one.must_have_no_gap(0.15, PENDING)


@check(
    points=8,
    hint="Count up for each request, and down for each answer.",
    todo="A joint waits from the moment when its message arrives until its answer has come, whether that says "
    "success or not, or until 5 s have passed since the request. Do not keep a number that you change in "
    "several places. Keep the joints themselves: a list of those that you could not ask for yet, and one "
    "entry per request that is not answered. The number is then the sum of the two lengths, and it can't "
    "go wrong.",
    depends=[test_asks],
    rule=("pending", "not_waiting", "never_wait", "count_topic"),
)
def test_number_of_pending(one: Run) -> None:
    """/calibrations_pending says how many joints wait: 1 until the answer arrives, then 0."""
    one.must_have_interface(PENDING)
    must_count(one)
    if not any(message.fields["data"] for message in one.messages_on(PENDING)):
        one.wrong_at(None, "expected 1 while a joint waits, got 0 throughout.", "", "1", "0")


@check(
    points=3,
    hint="super().__init__('calibration')",
    depends=[test_asks],
    rule=("node", "other_topics"),
)
def test_node_is_called_calibration(one: Run) -> None:
    """There is one node, it is called calibration, and it publishes on no other topics."""
    one.must_have_nodes()
    one.must_publish_on_no_others()


@check(
    points=3,
    hint="Catch KeyboardInterrupt and ExternalShutdownException around rclpy.spin, then call rclpy.try_shutdown().",
    depends=[test_asks],
    rule="ctrl_c",
)
def test_ends_on_ctrl_c(one: Run) -> None:
    """On Ctrl-C it ends within 2 s, with no traceback."""
    one.must_end_on_ctrl_c()
