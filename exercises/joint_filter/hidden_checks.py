"""The harder scenarios of `joint_filter`. Every rule that they rely on is in task.md."""

from __future__ import annotations

import itertools

from grader.checking import Exchange, Run, Wrong, check, each, fail
from grader.checking.verdict import Finding

FILTERS = ["test_filters"]

#: By how much a position may differ (rad).
TOLERANCE = 1e-6


def positions(exchange: Exchange) -> dict[str, float]:
    """Return the answer's positions by name; if it has no names, by those that arrived."""
    answer = exchange.answers[0]
    return dict(zip(answer.name or exchange.sent.name, answer.position, strict=False))


def own_gain(run: Run) -> tuple[int, float]:
    """Return the first of two messages in a row that the node answers, and its gain there, whatever that is.

    So another gain than the default fails the check of the default, and no check of anything else.
    """
    for before, now in itertools.pairwise(run):
        if before.answers and now.answers:
            first, got = positions(before), positions(now)
            arrived = now.sent.by("name", "position")
            moves = {name: arrived[name] - first[name] for name in first if name in got and name in arrived}
            farthest = max(moves, key=lambda name: abs(moves[name]), default="")
            if farthest and abs(moves[farthest]) > TOLERANCE:
                return before.number, (got[farthest] - first[farthest]) / moves[farthest]
    raise Wrong(Finding("Your node never answers two messages in a row. Expected one answer for each."))


def must_filter_by_its_own_gain(run: Run) -> None:
    """Fail unless each joint is filtered by its name, with the gain of the first two answers."""
    first, gain = own_gain(run)
    smooth: dict[str, float] = {}

    def judge(exchange: Exchange) -> None:
        for name, position in exchange.sent.by("name", "position").items():
            smooth[name] = smooth.get(name, position) + gain * (position - smooth.get(name, position))
        if exchange.answers:
            got = positions(exchange)
            if exchange.number == first:
                smooth.update(got)
            for name in exchange.sent.name:
                if name not in got or abs(got[name] - smooth[name]) > TOLERANCE * max(1.0, abs(smooth[name])):
                    text = f"expected position {smooth[name]:.6g} rad, got "
                    text += f"{got[name]:.6g} rad." if name in got else "none."
                    run.wrong(exchange, text, name, f"{smooth[name]:.6g} rad", f"{got.get(name, 'none')}")
            for name in set(got) - set(exchange.sent.name):
                run.wrong(exchange, "the joint is not in the message, so none was expected.", name, "none", got[name])

    each(itertools.islice(run, first - 1, None), judge)


@check(
    points=4,
    hint="Publish in the callback of the subscription, once, and nowhere else.",
    todo="A message without joints is a message: its answer has the same header, and empty lists. And a change "
    "of the gain is no message: publish nothing then, and do not answer the last message again. Look for "
    "a return such as `if not message.name`, and for a publish() in a callback of the parameter.",
    depends=FILTERS,
    rule="answer",
)
def test_answers_whatever_happens(changed: Run, empty: Run, new_joint: Run) -> None:
    """It publishes one message for each, also for one without joints, and none when the gain changes."""
    for run in (changed, empty, new_joint):
        run.must_answer()


@check(
    points=3,
    hint="Publish in the callback, not from a timer or from a thread that sleeps.",
    depends=FILTERS,
    misconception="answers late",
    rule="at_once",
)
def test_answers_at_once(default: Run) -> None:
    """Each answer goes out within 10 ms, and before the next message."""
    default.must_answer_at_once()


@check(
    points=3,
    hint="Copy the header as a whole. The node's clock says when the message arrived, not when it was true.",
    depends=["test_header"],
    misconception="time of arrival for the stamp",
    rule="copy",
)
def test_header_of_late_messages(delayed: Run) -> None:
    """The header is that of the message that arrived, even if it arrived late, or its frame changes."""
    delayed.must_match("header", missing_ok=True)


@check(
    points=3,
    hint="Everything that is more than 0.0 and at most 1.0 is allowed.",
    depends=FILTERS,
    rule=("parameter", "changed", "node"),
)
def test_gain_of_one(after_refusal: Run) -> None:
    """A gain of exactly 1.0 is accepted, and one of 0.01."""
    after_refusal.must_take("gain", 1.0)
    after_refusal.must_take("gain", 0.01)


@check(
    points=3,
    hint="Pass the default to declare_parameter().",
    depends=FILTERS,
    rule=("declared", "parameter", "node"),
)
def test_gain_can_be_read(default: Run) -> None:
    """The parameter gain can be read, and is 0.5."""
    default.must_have_parameter("gain")


@check(
    points=6,
    hint="Use a range in the descriptor, and an on-set callback that refuses 0.0.",
    todo="The range of a FloatingPointRange includes both of its ends, so 0.0 passes it, and some values that "
    "are no number may, too. Write the condition positively in the on-set callback: accept only if 0.0 < "
    "value <= 1.0 is true, and refuse everything else. Every comparison with nan is false, so `value <= "
    "0.0 or value > 1.0` lets it through. Look at the parameter's name first: the callback is called for "
    "all parameters.",
    depends=FILTERS,
    misconception="takes every gain",
    rule=("refused", "node"),
)
def test_refuses_what_is_not_allowed(refused: Run) -> None:
    """It refuses a gain of 0.0 or less, above 1.0, or not a number."""
    refused.must_refuse("gain")


@check(
    points=4,
    hint="Refuse before anything changes.",
    todo="The on-set callback is asked before anything is set. It may only say yes or no: if it stores the "
    "value in an attribute first, or clamps it, a refused gain counts all the same. Read the gain with "
    "get_parameter() where you use it, or store it in a post-set callback, which runs for accepted values "
    "only.",
    depends=["test_refuses_what_is_not_allowed"],
    rule="unchanged",
)
def test_goes_on_after_a_refusal(refused: Run) -> None:
    """After a refusal, the gain is unchanged."""
    values = [reading.value for reading in refused.recording.readings]
    for reading in refused.recording.readings:
        if reading.value != values[0]:
            text = f"expected {values[0]}, as before the refusal, got {reading.value}."
            refused.wrong_at(reading.at, text, "parameter gain", values[0], reading.value)
    must_filter_by_its_own_gain(refused)


@check(
    points=4,
    hint="A parameter keeps the type of its default, unless the descriptor says otherwise.",
    todo="declare_parameter('gain', 0.5) makes the parameter a double for good: rclpy itself then refuses 1, "
    "'1' and True. It stops doing so if the descriptor has dynamic_typing=True, or if the parameter is "
    "declared without a value. Do not convert with float() in the on-set callback: it makes something "
    "allowed of what is not.",
    depends=FILTERS,
    rule=("refused", "node"),
)
def test_refuses_other_types(other_types: Run) -> None:
    """It refuses an integer, a string and a bool."""
    other_types.must_refuse("gain")


@check(
    points=3,
    hint="SetParametersResult has a field for the reason.",
    depends=FILTERS,
    rule="reason",
)
def test_refuses_with_a_reason(refused: Run) -> None:
    """Each refusal has a reason."""
    for change in refused.recording.parameters:
        if change.taken is False and not change.reason:
            refused.wrong_at(change.at, f"{change.value} was refused without a reason.", "", "a reason", "none")


@check(
    points=5,
    hint="Remember positions by name, not by index in the list.",
    todo="The same index is another joint in the next message. Use a dictionary from the joint's name to its "
    "smooth position, and go through the message with zip(message.name, message.position). The answer has "
    "the names and the positions in the order of this message, not in the order of the dictionary.",
    depends=FILTERS,
    misconception="joints by index",
    rule=("by_name", "formula"),
)
def test_joints_in_another_order(reordered: Run) -> None:
    """It filters each joint by its name, in whatever order they arrive."""
    must_filter_by_its_own_gain(reordered)


@check(
    points=4,
    hint="Keep the smooth position of each joint, even when it is missing.",
    todo="Keep one dictionary for the whole life of the node, and change only the entries of the joints that "
    "are in the message. If you make a new dictionary for each message, a joint that is missing once is "
    "forgotten, and starts anew when it returns. Do not let a missing joint move either, for example "
    "towards 0.",
    depends=FILTERS,
    rule=("missing_joint", "formula"),
)
def test_missing_joint(missing_joint: Run) -> None:
    """A joint that was missing continues from its last smooth position."""
    must_filter_by_its_own_gain(missing_joint)


@check(
    points=4,
    hint="A joint that you don't know yet starts at its position.",
    todo="Ask the dictionary for each joint of each message, not only for those of the first message: a joint "
    "may appear at any time. If it has no entry, its smooth position is the position that has just "
    "arrived, not 0.0, and not the position of another joint. dict.get(name, position) does that in one "
    "call.",
    depends=FILTERS,
    rule=("new_joint", "formula"),
)
def test_new_joint(new_joint: Run) -> None:
    """A joint that appears later starts at its position."""
    must_filter_by_its_own_gain(new_joint)


@check(
    points=2,
    hint="Create each end once, in __init__, with a plain 10.",
    depends=FILTERS,
    rule="queue",
)
def test_quality_of_service(default: Run) -> None:
    """All ends are reliable and volatile with a depth of 10, and there is one publisher on each topic."""
    default.must_have_qos(depth=True)
    for topic in default.exercise.outputs:
        count = len(default.end_points("publisher", topic.name))
        if count != 1:
            fail(f"Publishers on {topic.name}.", expected=1, got=count)
