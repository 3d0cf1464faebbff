"""A check reads a message's fields by name, however deep they are."""

from __future__ import annotations

import pytest

from grader.checking import fail
from grader.recording.fields import Part

PATH = {"header": {"frame_id": "map"}, "poses": [{"position": {"x": 1.0}}, {"position": {"x": 2.0}}], "sizes": [1, 2]}


def test_messages_in_fields_and_in_lists_have_attributes_and_keys() -> None:
    message = Part(PATH)
    assert [pose.position.x for pose in message.poses] == [1.0, 2.0]
    assert message.poses[1]["position"]["x"] == 2.0
    assert message.sizes == [1, 2]
    with pytest.raises(AttributeError, match="Did you mean position"):
        _ = message.poses[0].positon


def test_messages_are_equal_if_their_fields_are() -> None:
    assert Part(PATH).header == Part({"header": {"frame_id": "map"}}).header == {"frame_id": "map"}
    assert Part(PATH).poses[0] != Part(PATH).poses[1]


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"expected": 1, "got": 2}, "Wrong. Expected 1, got 2."),
        ({"got": "tool"}, "Wrong. Got tool."),
        ({"expected": 1}, "Wrong. Expected 1."),
        ({}, "Wrong."),
    ],
)
def test_what_a_check_says_has_only_the_values_that_were_given(values: dict[str, object], message: str) -> None:
    with pytest.raises(AssertionError) as caught:
        fail("Wrong.", **values)  # type: ignore[arg-type]
    assert caught.value.finding.text == message  # type: ignore[attr-defined]
