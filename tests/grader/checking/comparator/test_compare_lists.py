"""Lists are equal if they have the same length and equal elements in the same order."""

from __future__ import annotations

import pytest

from grader.checking.comparator import Difference, difference, equal


@pytest.mark.parametrize(
    ("got", "expected", "found"),
    [
        ([], [], None),
        ([1.0], [1.0 + 1e-9], None),
        ([[], []], [[], []], None),
        ([], [0.0], Difference("", [], [0.0])),
        ([0.0], [], Difference("", [0.0], [])),
        ([1.0, 2.0], [1.0], Difference("", [1.0, 2.0], [1.0])),
        ([1.0, 2.0], [2.0, 1.0], Difference("[0]", 1.0, 2.0)),
        ([1.0, 2.0, 9.0], [1.0, 2.0, 3.0], Difference("[2]", 9.0, 3.0)),
        ([[1], [2, 3]], [[1], [2, 4]], Difference("[1][1]", 3, 4)),
        ([[1], []], [[1], [2]], Difference("[1]", [], [2])),
        (["a"], ["b"], Difference("[0]", "a", "b")),
        ("ab", ["a", "b"], Difference("", "ab", ["a", "b"])),
        (1.0, [1.0], Difference("", 1.0, [1.0])),
        (None, [], Difference("", None, [])),
    ],
)
def test_two_lists(got: object, expected: object, found: Difference | None) -> None:
    assert difference(got, expected) == found
    assert equal(expected, got) is (found is None)


def test_the_first_of_several_differences_is_found() -> None:
    found = difference([0.0] * 10_000 + [1.0, 1.0], [0.0] * 10_002)
    assert found
    assert found.path == "[10000]"
