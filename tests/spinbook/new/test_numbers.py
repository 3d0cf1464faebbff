"""Scenarios of numbers, in any message type, read as what happens."""

from __future__ import annotations

import math

import pytest

from grader.runner.message import filled, message_class, to_fields
from grader.scenario.numbers import (
    Stream,
    chosen,
    late,
    lost,
    numbers,
    paused,
    placed,
    restarted,
    together,
    twice,
    wave,
)
from grader.scenario.scenario import SECOND, START
from grader.scenario.times import every

TIMES = every(0.1, 2.0)
WAVE = numbers("/wanted", wave(1.5, TIMES, period=4.0))


def values(stream: Stream) -> list[float]:
    return [message.fields["data"] for message in stream]


def seconds(stream: Stream) -> list[float]:
    return [(message.at - START) / SECOND for message in stream]


def test_a_wave_swings_between_its_heights_at_its_instants() -> None:
    assert len(WAVE) == 20
    assert seconds(WAVE) == pytest.approx(TIMES)
    assert values(WAVE)[10] == 1.5
    assert {(message.topic, message.type) for message in WAVE} == {("/wanted", "")}, "the type is in exercise.toml"


def test_a_number_goes_into_any_field_of_any_message() -> None:
    [message] = numbers("/cmd_vel", [(0.5, 2.0)], type="geometry_msgs/msg/Twist", field="linear.x")
    twist = filled(message_class(message.type)(), message.fields)
    assert isinstance(twist, message_class("geometry_msgs/msg/Twist"))
    assert (twist.linear.x, twist.angular.z) == (2.0, 0.0)


def test_stamps_are_the_instants_and_move_with_a_pause() -> None:
    stream = numbers(
        "/range", [(0.0, 1.0), (0.5, 2.0)], type="sensor_msgs/msg/Range", field="range", stamped=True, max_range=9.0
    )
    fields = to_fields(filled(message_class(stream[1].type)(), paused(stream, 1, 30.25)[1].fields))
    assert fields["header"]["stamp"] == {"sec": 130, "nanosec": 750_000_000}
    assert (fields["range"], fields["max_range"]) == (2.0, 9.0)
    assert stream[1].fields["header"]["stamp"] == {"sec": 100, "nanosec": 500_000_000}, "the stream itself stays"


def test_other_fields_of_the_header_stay_next_to_the_stamp() -> None:
    [message] = numbers("/t", [(0.5, 2.0)], field="temperature", stamped=True, header={"frame_id": "kiln"})
    assert message.fields["header"] == {"frame_id": "kiln", "stamp": {"sec": 100, "nanosec": 500_000_000}}


def test_a_value_that_is_placed_in_a_field_without_a_number_is_refused() -> None:
    ranges = numbers("/range", [(0.0, 1.0)], field="range")
    assert placed(ranges, 0, 2.0, field="range")[0].fields["range"] == 2.0
    with pytest.raises(ValueError, match=r"message 0 on /range has no number in its field 'data'. Name the field"):
        placed(ranges, 0, 2.0)


def test_chance_is_the_same_for_a_seed_and_another_for_another() -> None:
    assert chosen(0.5, 3.0, TIMES, 1) == chosen(0.5, 3.0, TIMES, 1)
    assert chosen(0.5, 3.0, TIMES, 1) != chosen(0.5, 3.0, TIMES, 2)
    assert all(0.5 <= value <= 3.0 for _, value in chosen(0.5, 3.0, TIMES, 1))


def test_faults_change_what_they_say_and_nothing_else() -> None:
    assert math.isnan(values(placed(WAVE, 3, math.nan))[3])
    assert values(placed(WAVE, 3, 0.0))[4:] == values(WAVE)[4:]
    assert values(twice(WAVE, 3)) == [*values(WAVE)[:4], *values(WAVE)[3:]]
    assert [message.publisher for message in restarted(WAVE, 17)][16:] == [1, 1, 2, 2]
    kept = lost(WAVE, one_in=3, seed=1)
    assert (kept[0], kept[-1]) == (WAVE[0], WAVE[-1])
    assert 5 < len(kept) < len(WAVE)
    delayed = late(WAVE, 0.5, seed=1)
    assert seconds(delayed) == sorted(seconds(delayed))
    assert all(0 < now - then <= 0.5 for now, then in zip(seconds(delayed), seconds(WAVE), strict=True))


def test_streams_of_several_topics_go_together_in_time() -> None:
    both = together(WAVE, numbers("/other", [(0.05, 1.0), (0.1, 2.0)]))
    assert [message.topic for message in both[:5]] == ["/wanted", "/other", "/wanted", "/other", "/wanted"]
