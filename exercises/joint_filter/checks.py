"""What every student may read: the checks of `joint_filter`.

Each fixture is a scenario of scenarios.py; hidden_checks.py goes through the harder ones.
"""

from __future__ import annotations

import math
from dataclasses import replace

from grader.checking import Exchange, Run, check, each
from grader.checking.answers import pattern
from grader.recording.recording import ReceivedMessage

#: By how much a position may differ (rad).
TOLERANCE = 1e-6


def named(run: Run) -> Run:
    """Return the run with the names that arrived in answers without names, which are judged by a check of their own."""

    def with_names(answer: ReceivedMessage) -> ReceivedMessage:
        if answer.fields.get("name") != [] or not answer.after:
            return answer
        return replace(answer, fields={**answer.fields, "name": run.recording.sent[answer.after - 1].fields["name"]})

    received = tuple(with_names(answer) for answer in run.recording.received)
    return replace(run, recording=replace(run.recording, received=received))


def must_be_between(run: Run) -> None:
    """Fail unless each position is between the lowest and the highest one of this joint that arrived so far."""
    arrived: dict[str, list[float]] = {}

    def judge(exchange: Exchange) -> None:
        for name, position in exchange.sent.by("name", "position").items():
            arrived.setdefault(name, []).append(position)
        for answer in exchange.answers[:1]:
            for name, got in zip(answer.name or exchange.sent.name, answer.position, strict=False):
                lowest, highest = min(arrived.get(name, [got])), max(arrived.get(name, [got]))
                if not lowest - TOLERANCE <= got <= highest + TOLERANCE:
                    between = f"{lowest:.3f} to {highest:.3f} rad"
                    text = f"a smooth position is between those that arrived, {between}; got {got:.3f} rad."
                    cause = pattern(run, "position", "name", "rad")
                    run.wrong(exchange, text, name, between, f"{got:.3f} rad", cause)

    each(run, judge)


@check(
    points=4,
    hint="With which value does a joint start, and which part of the way does each message move it?",
    todo="Keep the smooth position of each joint, by its name, in an attribute of the node. A joint that you have "
    "not seen before starts at the position that arrived. After that, each message moves the smooth position "
    "a part of the way towards the new one: the gain says which part. With a gain of 0.5 it moves half of the "
    "way, so it is always between the positions that have arrived. A gain of 1 would copy them. Log the gain "
    "and one joint's numbers for three messages, and compare them with the formula by hand.",
    rule=("input", "output"),
    partial=True,
)
def test_filters(default: Run) -> None:
    """It subscribes to /joint_commands, and publishes positions on /joint_filtered that are smoother."""
    default.must_have_interface()
    default.must_publish()
    must_be_between(default)
    pairs = [(ex.sent.position, answer.position) for ex in default for answer in ex.answers[:1] if ex.sent.position]
    if all(len(a) == len(b) and all(map(math.isclose, a, b)) for a, b in pairs):
        default.wrong_at(None, "every position is the one that arrived.", "", "smoother positions", "the same")
    if len({tuple(got) for _, got in pairs}) == 1:
        default.wrong_at(None, "every message has the same positions.", "", "positions that change", "the same")


@check(
    points=6,
    hint="Call publish() once in the callback, whatever the message.",
    todo="Publish in the callback of the subscription, once, as its last line, outside the loop over the "
    "joints. Look at each `return` and each `if` before it: the first message, a message without joints, "
    "and one that changes nothing must be answered, too. Nothing else should publish: no timer, and not "
    "the on-set callback of the parameter.",
    depends=[test_filters],
    rule="answer",
    partial=True,
)
def test_answers_each_message(default: Run) -> None:
    """It publishes one message for each that arrives."""
    default.must_answer()


@check(
    points=12,
    hint="Compute the first messages of one joint by hand: smooth + gain * (position - smooth).",
    todo="Take one joint and compute its first three messages by hand. For the first, smooth is the position "
    "itself. For each further one, smooth moves from its former value towards the position, by half of "
    "the way if the gain is 0.5. So the result of one message must be kept for the next, per joint, in a "
    "dictionary that __init__ creates. If you keep the position that arrived instead, or mix up gain and "
    "1 - gain, the values look plausible and are wrong.",
    depends=[test_filters],
    rule=("formula", "declared", "new_joint"),
    partial=True,
)
def test_filters_with_the_default(default: Run) -> None:
    """By default, the gain is 0.5."""
    named(default).must_match("position", per="name", missing_ok=True)


@check(
    points=4,
    hint="Copy the names from the message that arrived.",
    depends=[test_filters],
    rule="copy",
    partial=True,
)
def test_names(default: Run) -> None:
    """The joints' names are those of the message that arrived, in their order."""
    default.must_match("name", missing_ok=True)


@check(
    points=4,
    hint="Copy the header as a whole.",
    depends=[test_filters],
    rule="copy",
    partial=True,
)
def test_header(default: Run) -> None:
    """The header is that of the message that arrived."""
    default.must_match("header", missing_ok=True)


@check(
    points=3,
    hint="super().__init__('joint_filter')",
    depends=[test_filters],
    rule=("node", "other_topics"),
)
def test_node_is_called_joint_filter(default: Run) -> None:
    """There is one node, it is called joint_filter, and it publishes on no other topics."""
    default.must_have_nodes()
    default.must_publish_on_no_others()


@check(
    points=8,
    hint="Does the formula use the gain that the node was started with, and with the right part of the way?",
    todo="A node is started with another value like this: `python3 joint_filter.py --ros-args -p gain:=0.2`. "
    "declare_parameter() takes a default for when nobody gives a value; get_parameter('gain').value is the "
    "value that counts. With 0.5, some mistakes can't be seen, because both parts of the formula weigh the "
    "same: with 0.2, smooth keeps four fifths of what it was, and takes one fifth of the new position. Start "
    "your node like that, and log the gain and one joint's numbers.",
    depends=[test_filters],
    misconception="fixed gain",
    rule=("start_value", "formula", "parameter", "new_joint"),
    partial=True,
)
def test_gain_of_the_start(started: Run) -> None:
    """The node can be started with another gain."""
    named(started).must_match("position", per="name", missing_ok=True)


@check(
    points=8,
    hint="Which gain does the formula use for the next message, and do the smooth positions stay as they are?",
    todo="get_parameter('gain').value is the gain as it is now. Read it in the callback for each message, "
    "rather than once in __init__. If you would rather keep it in an attribute, change that in a post-set "
    "callback, when the new value counts: the on-set callback runs before it is set, and get_parameter() "
    "still has the old one there. The smooth positions must stay when the gain changes.",
    depends=[test_filters_with_the_default],
    misconception="reads the gain once",
    rule=("changed", "keeps", "formula", "parameter", "node"),
)
def test_gain_that_changes(changed: Run) -> None:
    """A new gain counts from the next message on."""
    changed.must_take("gain")
    named(changed).must_match("position", per="name", missing_ok=True)


@check(
    points=3,
    hint="Catch KeyboardInterrupt and ExternalShutdownException around rclpy.spin, then call rclpy.try_shutdown().",
    depends=[test_filters],
    rule="ctrl_c",
)
def test_ends_on_ctrl_c(default: Run) -> None:
    """On Ctrl-C it ends within 2 s, with no traceback."""
    default.must_end_on_ctrl_c()
