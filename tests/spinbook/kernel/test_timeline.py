"""Timelines of services, actions and topics: recordings become lanes, and lanes become a moving picture."""

from __future__ import annotations

import json
from pathlib import Path
from xml.etree import ElementTree as ET

from browser import opened
from playwright.sync_api import Browser

from ros_in_python.animation import still
from spinbook.kernel.timeline import Lane, RecordedEvents, in_words, lanes
from spinbook.kernel.timeline_picture import timeline_svg

Event = tuple[float, str, str]


def recorded(name: str, kind: str, *events: Event) -> tuple[Lane, ...]:
    """Return the lanes of events (time in s, what, goal) with one name."""
    happenings = RecordedEvents()
    happenings.take([json.dumps(["found", name, kind]), "something that a library printed"])
    happenings.take(json.dumps(["event", at, name, what, goal, ""]) for at, what, goal in events)
    return lanes(happenings)


def test_a_goal_waits_runs_and_is_canceled() -> None:
    (lane,) = recorded(
        "/move",
        "action",
        (0.0, "goal", "a"),
        (0.1, "EXECUTING", "a"),
        (0.2, "feedback", "a"),
        (0.5, "cancel", "a"),
        (0.6, "CANCELING", "a"),
        (0.6, "cancel answered", ""),
        (0.8, "CANCELED", "a"),
    )

    assert [(bar.look, bar.start, bar.end, bar.open) for bar in lane.spans] == [
        ("waits", 0.0, 0.1, False),
        ("runs", 0.1, 0.6, False),
        ("cancels", 0.6, 0.8, False),
    ]
    assert [mark.text for mark in lane.marks if mark.text] == ["goal", "cancel", "answer to cancel", "CANCELED"]


def test_a_rejection_belongs_to_the_goal_that_never_ran_and_a_goal_without_an_end_stays_open() -> None:
    first, second = recorded(
        "/move",
        "action",
        (0.0, "goal", "a"),
        (0.0, "accepted", ""),
        (0.1, "EXECUTING", "a"),
        (1.0, "goal", "b"),
        (1.1, "rejected", ""),
        (2.0, "feedback", "a"),
    )

    assert first.spans[-1].open
    assert "rejected" not in [mark.text for mark in first.marks]
    assert [(bar.look, bar.end, bar.open) for bar in second.spans] == [("waits", 1.1, False)]
    assert second.marks[-1].text == "rejected"


def test_responses_come_in_the_order_of_requests_and_a_missing_one_is_seen() -> None:
    (lane,) = recorded(
        "/power",
        "service",
        (0.0, "response", ""),
        (1.0, "request", ""),
        (1.2, "request", ""),
        (1.5, "response", ""),
        (2.0, "response", ""),
        (3.0, "request", ""),
    )

    assert [(bar.start, bar.end, bar.open) for bar in lane.spans] == [
        (1.0, 1.5, False),
        (1.2, 2.0, False),
        (3.0, 3.0, True),
    ]


def test_the_words_say_how_long_a_topic_was_silent() -> None:
    drawn = recorded("/ticks", "topic", (10.0, "message", ""), (10.1, "message", ""), (11.6, "message", ""))

    assert in_words(drawn, 10.0) == "/ticks: 3 messages from 0.00 to 1.60 s, longest gap 1.50 s"


def test_the_picture_is_still_for_who_wants_no_motion_and_has_no_faults(browser: Browser, tmp_path: Path) -> None:
    drawn = recorded("/<move>", "action", (0.0, "goal", "a"), (0.1, "EXECUTING", "a"), (2.0, "SUCCEEDED", "a"))
    svg = timeline_svg(drawn)
    ET.fromstring(svg)
    live = timeline_svg(drawn, "Moving <slowly>", moves=False)
    texts = {node.text for node in ET.fromstring(live).iter("{http://www.w3.org/2000/svg}text")}
    assert {"Moving <slowly>", "/<move> goal 1", "SUCCEEDED", "2 s"} <= texts
    assert live == still(live)
    later = timeline_svg(recorded("/<move>", "topic", (0.0, "message", "")), "Moving <slowly>", moves=False)
    identities = [{node.get("id") for node in ET.fromstring(each)} - {None} for each in (live, later)]
    assert not identities[0] & identities[1], "both may be in one notebook"
    (tmp_path / "page.html").write_text("<!doctype html><title>timeline</title>" + svg)
    animations = "document.getAnimations().length"
    with opened(browser, tmp_path / "page.html") as shown:
        assert shown.page.evaluate(animations) == 2
        shown.page.emulate_media(reduced_motion="reduce")
        assert shown.page.evaluate(animations) == 0
        assert "SUCCEEDED" in (shown.page.text_content("svg") or "")
        assert shown.faults == []
