"""The plot that is drawn again: all curves, at the recorded speed, and without motion if preferred."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
from browser import opened
from playwright.sync_api import Browser

from ros_in_python.animation import BEFORE_S, still
from spinbook.kernel.plot.picture import FOR_NOTEBOOKS, MOST_CURVES, Scale, around, in_words, plot_svg
from spinbook.kernel.plot.recording import PlotRecording, RecordingTime

JOINTS = ["left_elbow", "right_elbow", "<b>&"]


def recorded(
    value: Callable[[float], float] = math.sin, seconds: float = 4.0, joints: list[str] = JOINTS
) -> PlotRecording:
    """Return a recording of joints at 10 Hz."""
    recording = PlotRecording()
    recording.take(
        json.dumps(["sample", "/joint_commands", "position", "rad", joint, 100 + n / 10, value(n / 10 + offset)])
        for n in range(int(seconds * 10) + 1)
        for offset, joint in enumerate(joints)
    )
    return recording


def curves_of(svg: str) -> list[str]:
    """Return the paths of the curves."""
    (group,) = (node for node in ET.fromstring(svg).iter() if node.get("clip-path"))
    return [path.attrib["d"] for path in group]


def test_it_has_the_curves_with_names_and_units_in_a_few_kilobytes() -> None:
    svg = plot_svg(recorded())
    root = ET.fromstring(svg)
    texts = [node.text for node in root.iter("{http://www.w3.org/2000/svg}text")]

    assert {"/joint_commands", "position (rad)", "4 s", *JOINTS} <= set(texts)
    assert len(svg) < 6_000
    assert svg == plot_svg(recorded())
    assert not re.search(r"<script|https?://(?!www\.w3\.org/2000/svg)|@import|<image", svg)
    assert "left_elbow: 41 samples" in svg


def test_noise_is_capped() -> None:
    assert len(plot_svg(recorded(lambda t: math.sin(1e4 * t), seconds=300))) < 13_000


def test_a_notebook_that_is_watched_shows_noise_as_it_is_and_nothing_moves() -> None:
    svg = plot_svg(recorded(lambda t: math.sin(1e4 * t), seconds=150, joints=["a"]), moves=False)

    (curve,) = curves_of(svg)
    assert curve.count("l") > 500
    assert f'width="{FOR_NOTEBOOKS}"' in svg
    assert svg == still(svg)


def test_a_long_square_wave_keeps_its_height() -> None:
    (curve,) = curves_of(plot_svg(recorded(lambda t: round(t * 10) // 3 % 2, seconds=60, joints=["a"])))
    ups = [float(step.replace("-", " -").split()[1]) for step in curve.split("l")[1:]]
    assert min(ups) < -130
    assert max(ups) > 130


def test_a_clock_that_was_put_back_and_a_name_with_a_control_character_are_drawn() -> None:
    recording = PlotRecording()
    for when in (1e9, 3.0, 4.0):
        recording.note("sample", "/joints", "position", "rad", "el\x08bow", when, 1.0)
    assert len(curves_of(plot_svg(recording))) == 1


def test_a_name_that_is_wider_than_the_picture_ends_in_it() -> None:
    name = "/robot/left_arm/joint_states " + "left_shoulder_pitch_joint" * 2
    svg = plot_svg(recorded(joints=[name]))
    (shown,) = (node.text for node in ET.fromstring(svg).iter() if node.text and node.text.startswith("…"))
    assert name.endswith(shown[1:])
    assert 40 < len(shown) < 55
    assert f"{name}: 41 samples" in svg


def test_words_and_axis_are_of_the_values_that_can_be_drawn() -> None:
    values = [math.nan, 1.0, math.inf, 2.0, -1.7e308, 1.7e308]
    recording = recorded(lambda t: values[round(t * 10)], seconds=0.5, joints=["a"])
    assert "6 samples, 1.000 … 2.000 rad" in plot_svg(recording)
    assert "none can be drawn" in in_words(recorded(lambda t: math.nan, joints=["a"]))


def test_a_constant_curve_and_one_with_a_hole_do_not_hurt() -> None:
    (constant,) = curves_of(plot_svg(recorded(lambda t: 0.0, joints=["left_elbow"])))
    assert constant.startswith("M50 ")
    values = [1.0, 2.0, math.nan, 3.0, math.inf, 4.0, 5.0, math.nan]
    recording = recorded(lambda t: values[round(t * 10) % 8], seconds=0.7, joints=["holes"])
    assert [piece.count("l") for piece in curves_of(plot_svg(recording))[0].split("M")[1:]] == [1, 0, 1]
    assert curves_of(plot_svg(recorded(lambda t: math.nan, joints=["a"]))) == [""]
    alternating = recorded(lambda t: 1.0 if round(t * 10) % 2 else math.nan, seconds=100, joints=["a"])
    assert curves_of(plot_svg(alternating))[0].count("M") == 500


@pytest.mark.parametrize("recording", [recorded(seconds=0), recorded(joints=list(map(str, range(99))))])
def test_what_can_not_move_is_drawn_without_motion(recording: PlotRecording) -> None:
    svg = plot_svg(recording)
    assert len(curves_of(svg)) == len(recording.curves)
    assert all("l" in curve or "h" in curve for curve in curves_of(svg)), "a single sample is seen, too"
    assert svg == still(svg)
    assert still(plot_svg(recorded())) != plot_svg(recorded())
    assert MOST_CURVES < 99


def test_marks_are_round_and_few() -> None:
    assert Scale(-0.9, 0.9, 0, 100).marks() == [-0.5, 0.0, 0.5]
    assert Scale(0, 30, 0, 100).marks() == [0, 10, 20, 30]
    for low, high in ((0.0, 1e-6), (-3.0, 1e9), (5.0, 5.1)):
        assert 2 <= len(Scale(low, high, 0, 1).marks()) <= 6
    assert around([2.0], 0, 1).low < 2.0


_WINDOW = """ms => {
    for (const each of document.getAnimations()) { each.pause(); each.currentTime = ms; }
    const matrix = new DOMMatrix(getComputedStyle(document.querySelector('clipPath rect')).transform);
    return [matrix.a, document.getAnimations().length];
}"""


def test_in_a_browser_the_window_grows_as_time_went_by(browser: Browser, tmp_path: Path) -> None:
    (tmp_path / "page.html").write_text("<!doctype html><title>plot</title>" + plot_svg(recorded()))
    with opened(browser, tmp_path / "page.html") as shown:
        for seconds, seen in ((-0.2, 0), (1.0, 0.25), (2.0, 0.5), (4.0, 1), (5.0, 1)):
            part, _ = shown.page.evaluate(_WINDOW, 1000 * (BEFORE_S + seconds))
            assert part == pytest.approx(seen, abs=0.01)
        shown.page.emulate_media(reduced_motion="reduce")
        assert shown.page.evaluate(_WINDOW, 0) == [1, 0]
        assert shown.faults == []


def test_curves_have_the_order_of_the_paths_whichever_topic_came_first() -> None:
    recording = PlotRecording()
    recording.note("topics", ["/left", "/right"])
    for topic in ("/right", "/left"):
        recording.note("sample", topic, "tilt", "rad", topic, 5.0, 0.1)
    assert [line.split(":")[0] for line in in_words(recording).splitlines()] == ["tilt /left", "tilt /right"]


def test_the_seconds_count_from_the_first_sample_and_a_slow_start_is_no_silence() -> None:
    recording, time = PlotRecording(), RecordingTime(seconds=3.0, now=0.0)
    assert not time.is_over(recording, 25.0), "the recorder has not started yet"
    recording.take(['["looking"]'])
    assert not time.is_over(recording, 26.0)
    assert not time.is_over(recording, 32.0), "a topic may take its time to appear"
    recording.take(['["sample", "/tilt", "tilt", "rad", "", 5.0, 0.1]'])
    assert not time.is_over(recording, 32.5)
    assert not time.is_over(recording, 35.0)
    assert time.is_over(recording, 35.6)


def test_a_recorder_that_hears_nothing_is_given_up() -> None:
    recording, time = PlotRecording(), RecordingTime(seconds=3.0, now=0.0)
    recording.take(['["looking"]'])
    assert not time.is_over(recording, 1.0)
    assert time.is_over(recording, 8.5)
