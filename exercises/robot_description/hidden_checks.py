"""The harder scenarios of `robot_description`. Every rule that they rely on is in task.md."""

from __future__ import annotations

from grader.checking import Run, check, fail

PUBLISHES = ["test_publishes_the_description"]
PARAMETER = "robot_description"


def squeezed(text: str) -> str:
    """Return a text without spaces and line breaks: whether these are right is judged by a check of its own."""
    return "".join(text.split())


def must_publish_each_change(run: Run) -> None:
    """Fail unless each text that is set is taken, and published once within 0.1 s."""
    run.must_take(PARAMETER)
    for change in run.recording.parameters:
        soon = [m for m in run.messages_on() if change.at <= m.at <= change.at + 0.110001]
        texts = [squeezed(message.fields["data"]) for message in soon]
        if texts != [squeezed(change.value)]:
            got = soon[0].fields["data"] if soon else "nothing"
            text = "the new text was expected within 0.1 s, once, got "
            text += f"{len(soon)} messages." if len(soon) > 1 else "another text." if soon else "nothing."
            run.wrong_at(change.at, text, "", change.value, got)


@check(
    points=4,
    hint="A post-set callback sees the new value; an on-set callback does not.",
    todo="add_post_set_parameters_callback(self.on_changed) in __init__ has a method called after parameters "
    "have been set, with a list of them. Look for the one with the right name, and publish its value, "
    "parameter.value. In an on-set callback, get_parameter() still gives the former text, and the new one "
    "may yet be refused by another callback. Publish it even if it was published once before, but not "
    "twice in a row.",
    depends=PUBLISHES,
    misconception="publishes the former text",
    rule=("change", "node"),
)
def test_description_that_changes(changed: Run) -> None:
    """When the parameter changes, the new description is published, once."""
    must_publish_each_change(changed)


@check(
    points=2,
    hint="With what is a new text compared, and how? Only the text that is there now counts, letter by letter.",
    todo="Set these texts one after the other and watch /robot_description: one text, the same with a line break "
    "at its end, the first one again, and `<robot/>`. Each is a new text, and each is valid. Compare with "
    "== and with the current text alone, not with a set of all that were published, and not after strip() or "
    "split(). Refuse only what the task refuses: a robot needs neither a name nor links. Publish the whole "
    "text, however long.",
    depends=["test_description_that_changes"],
    rule=("change", "as_it_is", "refused"),
)
def test_every_change_counts(little: Run) -> None:
    """A text that differs in a line break only, that was there before, or that is short or long, is a new text, too."""
    must_publish_each_change(little)


@check(
    points=2,
    hint="The depth is how many messages the publisher keeps for late subscribers.",
    depends=["test_late_subscriber"],
    rule=("late", "qos"),
)
def test_late_subscriber_gets_the_newest(changed: Run) -> None:
    """Late subscribers get the newest description, once, and no older one."""
    for name, seconds in (("late at 0.8 s", 0.8), ("late at 1.6 s", 1.6)):
        every = [(m.at >= seconds, m.fields["data"]) for m in changed.messages_on()]
        before, after = [text for late, text in every if not late], [text for late, text in every if late]
        got = [message.fields["data"] for message in changed.messages_on(subscriber=name)]
        if got != before[-1:] + after:
            text = f"the subscriber “{name}” was to get the newest description, got {len(got)} messages."
            changed.wrong_at(None, text, "", "the newest description", f"{len(got)} messages")


@check(
    points=2,
    hint="Publish the string of the parameter, without changing it.",
    depends=PUBLISHES,
    rule="as_it_is",
)
def test_text_as_it_is(started: Run, changed: Run) -> None:
    """The text has all its spaces, line breaks and empty lines."""
    for run in (started, changed):
        right = {squeezed(m.fields["data"]): m.fields["data"] for m in run.messages_on(reference=True)}
        for message in run.messages_on():
            got = message.fields["data"]
            if got != right.get(squeezed(got), got):
                text = "the text differs from the parameter's in its spaces or line breaks."
                run.wrong_at(message.at, text, "", repr(right[squeezed(got)]), repr(got))


@check(
    points=1,
    hint="Compare with the text that was published last.",
    depends=PUBLISHES,
    rule=("nothing_else", "same_text"),
)
def test_same_text_again(same: Run) -> None:
    """Nothing is published when the parameter is set to the text that it already has."""
    text = squeezed(same.recording.parameters[0].value)
    count = sum(squeezed(message.fields["data"]) == text for message in same.messages_on())
    if count > 1:
        same.wrong_at(None, f"the same text was set again: expected one message with it, got {count}.", "", 1, count)


@check(
    points=2,
    hint="Try to read the text as XML before you accept it.",
    todo="Let the on-set callback read the text with ElementTree.fromstring(), inside try. If it raises "
    "ElementTree.ParseError, the text is not XML: refuse it. If the tag of what it returns is anything "
    "but robot, in these very letters, refuse it, too. Do not look for '<robot' in the text: a comment or "
    "an XML declaration may come first, and the word may stand somewhere inside.",
    depends=PUBLISHES,
    misconception="takes every text",
    rule=("refused", "survives", "node"),
)
def test_refuses_what_is_no_robot(refused: Run) -> None:
    """It refuses texts that are not XML, and XML that is not about a robot."""
    refused.must_refuse(PARAMETER)


@check(
    points=1,
    hint="SetParametersResult has a field for the reason.",
    depends=PUBLISHES,
    rule=("reason", "survives"),
)
def test_refuses_with_a_reason(refused: Run) -> None:
    """Each refusal has a reason."""
    for change in refused.recording.parameters:
        if change.taken is False and not change.reason:
            refused.wrong_at(change.at, "a text was refused without a reason.", "", "a reason", "none")


@check(
    points=1,
    hint="Publish in the post-set callback, not in the on-set callback.",
    depends=PUBLISHES,
    rule=("unchanged", "survives"),
)
def test_publishes_nothing_refused(refused: Run) -> None:
    """A text that is refused is not published, and the parameter stays as it was."""
    texts = {change.value for change in refused.recording.parameters if change.taken is False}
    for message in refused.messages_on():
        if message.fields["data"] in texts:
            text = "expected nothing: this text was refused."
            refused.wrong_at(message.at, text, "", "nothing", message.fields["data"])
    again = [m for m in refused.messages_on() if m.at >= refused.recording.parameters[0].at]
    for change in refused.recording.parameters:
        if change.taken is False and any(change.at <= m.at <= change.at + 0.110001 for m in again):
            refused.wrong_at(change.at, "a text was refused: expected nothing, got a message.", "", "nothing", "one")


@check(
    points=1,
    hint="An exception in a callback ends the node.",
    depends=PUBLISHES,
    rule=("survives", "node"),
)
def test_goes_on_after_a_bad_text(after_refusal: Run) -> None:
    """After an invalid text, it accepts the next valid one."""
    after_refusal.must_take(PARAMETER, after_refusal.recording.parameters[1].value)


@check(
    points=1,
    hint="Create the publisher once, in __init__.",
    depends=PUBLISHES,
    rule="one_publisher",
)
def test_one_publisher(late: Run, changed: Run) -> None:
    """There is exactly one publisher on /robot_description."""
    for run in (late, changed):
        if (count := len(run.publishers("/robot_description"))) != 1:
            fail("Publishers on /robot_description.", expected=1, got=count)
