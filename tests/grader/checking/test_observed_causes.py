"""What a whole run shows of the cause of a failure: it comes first, whichever check notices the failure."""

from __future__ import annotations

import re
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from made_up import EMPTY, ENDS, EXERCISE, FLOAT, STAMPED, finding, ns, published, run

from grader.checking import doubts, observed
from grader.checking.hint_texts import texts
from grader.checking.plugin import suited
from grader.checking.verdict import CheckOptions
from grader.exercise.exercise import Elements, Topic
from grader.recording import Ending, Endpoint, ParameterChange, ReceivedMessage, Recording, SentMessage

RIGHT = published((0.1, 0.2, 0.3), (1.0, 2.0, 3.0))


def fails(recording: Recording) -> Any:
    """Return the finding of a check of values."""
    return finding(lambda: run(recording, RIGHT).must_match_series("data"))


def test_an_exception_comes_before_what_follows_from_it() -> None:
    raised = "Your program raised an exception: KeyError: 'x' in line 3."
    mine = replace(published((), ()), ending=Ending("completed", survived=raised))

    found = fails(mine)

    assert found.text.endswith(f"never published anything. {raised}")
    assert found.cause == raised
    assert found.where.startswith("Line 3 ends with KeyError. Which values")


def sets(**answer: Any) -> Recording:
    return replace(published((), ()), parameters=(ParameterChange(ns(1), "/worker", "gain", 0.2, **answer),))


def with_publisher(topic: str, values: tuple[float, ...]) -> Recording:
    end = Endpoint("/other", "publisher", topic, FLOAT, "reliable", "volatile")
    return replace(published((0.1, 0.2, 0.3), values), end_points=(*ENDS, end))


@pytest.mark.parametrize(
    ("mine", "cause", "todo"),
    [
        (sets(taken=False, reason="is undeclared"), "Your node has no parameter gain.", "declare_parameter('gain',"),
        (sets(), "Your node does not answer when somebody sets a parameter.", "only while rclpy.spin(node)"),
        (sets(taken=True), "", ""),
        (with_publisher("/in", (1.0, 2.0, 4.0)), "Your program also has a publisher on /in: it hears its", "on /in"),
        (with_publisher("/out", (1.0, 5.0, 4.0)), "Your program has 2 publishers on /out, in /other, /worker.", "one"),
        (with_publisher("/out", (-1.0, -2.0, -3.0)), "Every value has the wrong sign.", ""),
        (published((0.1, 0.2, 0.3), (1.0, 5.0, 4.0)), "", ""),
    ],
)
def test_what_the_graph_and_the_parameters_show(mine: Recording, cause: str, todo: str) -> None:
    found = fails(mine)

    assert found.cause.startswith(cause), found.cause
    assert bool(cause) == bool(found.cause)
    assert todo in found.todo


def test_a_check_that_depends_on_others_keeps_its_own_hints_if_nothing_is_published() -> None:
    silent = fails(published((), ()))
    first, later = (CheckOptions(1.0, "Author's hint.", depends, "") for depends in ((), ("test_publishes",)))

    assert suited(silent, first).where.startswith("Which method calls publish()")
    assert suited(silent, later) == replace(silent, where="", todo="")
    sign = fails(published((0.1, 0.2, 0.3), (-1.0, -2.0, -3.0)))
    assert suited(sign, later) == sign


def test_a_program_that_ends_is_one_cause_for_all_checks_and_named_without_its_words() -> None:
    ended = Ending("crashed", "Your program ended at message 3: Mine: IndexError of 0.25 in line 7.", 7)

    found = fails(replace(EMPTY, ending=ended))

    assert found.where.startswith("Line 7 ends with IndexError.")
    assert found.cause == found.where
    hung = fails(replace(EMPTY, ending=Ending("timed-out", "It never responds.")))
    assert hung.where.startswith("Here your node stops responding.")


def test_an_int_in_a_float_field_is_recognized_by_the_number_that_arrives() -> None:
    found = fails(published((0.1, 0.2, 0.3), (5e-324, 1e-323, 1.5e-323)))

    assert "data on /out is 4.94e-324, next to nothing: your node put an int into a float field." in found.text
    assert "Write 1.0 instead of 1" in found.todo
    assert "int" not in fails(published((0.1, 0.2, 0.3), (1e-300, 2e-300, 3e-300))).text


def test_a_lifecycle_node_that_nobody_configured_is_named() -> None:
    events = Endpoint("/worker", "publisher", "/worker/transition_event", FLOAT, "reliable", "volatile")

    found = fails(replace(EMPTY, end_points=(*ENDS, events)))

    assert "/worker is a lifecycle node, and it was never configured and activated" in found.text


def test_values_without_names_are_not_called_missing() -> None:
    out = Topic("/out", FLOAT, "publish", units={"speed": "m/s"}, elements=Elements("wheel", "name"))
    exercise = replace(EXERCISE, topics=(EXERCISE.topics[0], out))

    def robot(names: list[str], speeds: tuple[float, ...] = (1.0, 2.0)) -> Recording:
        fields = {"name": names, "speed": [*speeds]}
        return replace(EMPTY, received=(ReceivedMessage(ns(0.1), 0, "/out", FLOAT, fields),))

    wrong, right = run(robot(["left"], ()), robot(["left"]), exercise), robot(["left", "right"])
    assert finding(lambda: wrong.must_match_series("speed")).cause == "speed is empty in every message on /out."
    found = finding(lambda: run(robot([]), right, exercise).must_match_series("name"))

    assert found.cause == ("name is empty in every message on /out: nobody can know which wheel each speed belongs to.")


def test_a_number_that_is_always_0_is_named_along_with_one_that_is_not() -> None:
    out = Topic("/out", FLOAT, "publish", units={"ahead": "m/s", "turn": "rad/s"})
    exercise = replace(EXERCISE, topics=(EXERCISE.topics[0], out))

    def robot(**values: float) -> Recording:
        fields = {"ahead": 0.0, "turn": 0.0, "roll": 0.0, **values}
        return replace(EMPTY, received=tuple(ReceivedMessage(ns(i), i, "/out", FLOAT, fields) for i in range(3)))

    right = robot(ahead=1.0, turn=2.0)
    for mine, seen in (
        (robot(turn=2.0), "ahead is 0 in all 3 messages on /out, and turn is not."),
        (robot(roll=2.0), "ahead and turn are 0 in all 3 messages on /out, and roll is not."),
        (robot(), "ahead is 0 in all 3 messages on /out."),
    ):
        assert finding(partial(run(mine, right, exercise).wrong_at, None, "x")).cause == seen
    known = finding(lambda: run(robot(turn=2.0), right, exercise).wrong_at(None, "x", cause="Known."))
    assert known.cause == "Known."


def test_a_message_that_is_kept_and_filled_again_is_named() -> None:
    out = Topic("/out", FLOAT, "publish", units={"speed": "m/s"}, elements=Elements("wheel", "name"))
    exercise = replace(EXERCISE, topics=(EXERCISE.topics[0], out))

    def robot(*counts: int) -> Recording:
        fields = [{"name": ["left"] * count, "speed": [1.0] * count} for count in counts]
        return replace(EMPTY, received=tuple(ReceivedMessage(ns(i), i, "/out", FLOAT, f) for i, f in enumerate(fields)))

    found = finding(lambda: run(robot(1, 2, 3, 4), robot(1, 1, 1, 1), exercise).must_match_series("speed"))

    assert found.cause == "speed on /out gets longer with each message: 1, 2, 3 elements."
    grows = finding(lambda: run(robot(1, 2, 3, 5), robot(1, 2, 3, 4), exercise).must_match_series("speed"))
    assert "gets longer" not in grows.cause, "so does the solution's"


def test_numbers_that_are_all_zero_are_named() -> None:
    assert fails(published((0.1, 0.2, 0.3), (0.0, 0.0, 0.0))).cause == "data is 0 in all 3 messages on /out."


def test_messages_at_one_moment_have_no_rate() -> None:
    mine = run(published((0.1, 0.1, 0.1), (1.0, 2.0, 3.0)), RIGHT)

    found = finding(lambda: mine.must_keep_rate(10.0))

    assert found.text == (
        "At 0.10 s (as usual): all 3 messages on /out were published at one moment, 10 per second were expected. "
        "No time passed between them."
    )


@pytest.mark.parametrize(("late", "untested"), [(0.0, True), (0.3, False)])
def test_a_copied_stamp_is_tested_only_where_messages_are_late(late: float, untested: bool) -> None:
    def stamped(at: float) -> dict[str, Any]:
        sec, nanosec = divmod(ns(at), 1_000_000_000)
        return {"header": {"stamp": {"sec": sec, "nanosec": nanosec}, "frame_id": ""}}

    sent = tuple(SentMessage(ns(at + late), "/in", STAMPED, stamped(at)) for at in (0.1, 0.2))
    got = tuple(ReceivedMessage(one.at_ns, number, "/out", STAMPED, one.fields) for number, one in enumerate(sent, 1))
    doubts.begin()

    run(replace(EMPTY, sent=sent, received=got)).must_match("header.stamp")

    assert bool(doubts.untested()) is untested


def test_every_hint_is_used_and_filled_in_and_not_longer_than_a_student_reads() -> None:
    sources = "".join(file.read_text(encoding="utf-8") for file in Path(observed.__file__).parent.glob("*.py"))

    assert set(re.findall(r'hints\(\s*"(\w+)"', sources)) == set(texts())
    for name, (where, todo) in texts().items():
        assert where.endswith(("?", ".")), name
        assert todo.endswith(("?", ".")), name
        assert 30 <= len(f"{where} {todo}".split()) <= 160, name
