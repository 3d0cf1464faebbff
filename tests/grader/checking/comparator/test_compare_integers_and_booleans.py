"""Integers and booleans are equal only if they are the same, whatever the tolerance; a boolean equals no number."""

from __future__ import annotations

import pytest

from grader.checking.comparator import equal


@pytest.mark.parametrize(
    ("got", "expected", "same"),
    [
        (3, 3, True),
        (1_000_000, 1_000_001, False),
        (2**63 - 1, 2**63 - 2, False),
        (-1, 1, False),
        (True, True, True),
        (False, True, False),
        (True, 1, False),
        (0, False, False),
        (1.0, True, False),
        # a float on one side: an author's own value may be written without a point
        (3.0, 3, True),
        (3, 3.0000001, True),
        (3, 3.1, False),
        ({"sec": 100, "nanosec": 500_000_001}, {"sec": 100, "nanosec": 500_000_000}, False),
    ],
)
def test_integers_and_booleans(got: object, expected: object, same: bool) -> None:
    assert equal(got, expected, 1e-6) is same
    assert equal(expected, got, 1e-6) is same
