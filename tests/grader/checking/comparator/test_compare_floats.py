"""Floats are equal within a tolerance, or within a millionth of the larger of the two, whichever allows more."""

from __future__ import annotations

import math
import sys

import pytest

from grader.checking.comparator import TOLERANCE, Difference, difference, equal

BIG, TINY = sys.float_info.max, 5e-324


@pytest.mark.parametrize(
    ("got", "expected", "tolerance", "same"),
    [
        # the absolute tolerance, near zero: its edge is inside
        (1e-6, 0.0, 1e-6, True),
        (math.nextafter(1e-6, 1), 0.0, 1e-6, False),
        (-1e-6, 0.0, 1e-6, True),
        (math.nextafter(-1e-6, -1), 0.0, 1e-6, False),
        (0.0, 1e-6, 1e-6, True),
        (5e-7, -5e-7, 1e-6, True),
        # a tolerance is in the field's unit, and not a part of the value: half a pixel of 20
        (20.5, 20.0, 0.5, True),
        (15.0, 20.0, 0.5, False),
        # one part in a million of the larger of the two
        (1e9 + 900, 1e9, 1e-6, True),
        (1e9 + 1100, 1e9, 1e-6, False),
        (-1e9 - 900, -1e9, 1e-6, True),
        # the larger one, if both apply
        (0.5, 0.5 + 9e-7, 1e-6, True),
        (0.5, 0.5 + 1.1e-6, 1e-6, False),
        (2.0, 2.0 + 1.9e-6, 1e-6, True),
        (2.0, 2.0 + 2.1e-6, 1e-6, False),
        # no tolerance at all
        (0.1 + 0.2, 0.3, 0.0, False),
        (0.3, 0.3, 0.0, True),
        (TINY, 0.0, 0.0, False),
        # a wide one
        (1.5, 1.0, 0.5, True),
        (-1.0, 1.0, 0.5, False),
        # the ends of the range
        (BIG, BIG, 1e-6, True),
        (BIG, -BIG, 1e-6, False),
        (TINY, 0.0, 1e-6, True),
        # what 0.1 is in a float32 field, sent by both
        (0.10000000149011612, 0.1, 1e-6, True),
    ],
)
def test_two_floats(got: float, expected: float, tolerance: float, same: bool) -> None:
    assert equal(got, expected, tolerance) is same
    assert equal(expected, got, tolerance) is same, "neither side is special"


def test_without_a_tolerance_it_is_one_part_in_a_million() -> None:
    assert TOLERANCE == 1e-6
    assert equal(1.0 + 0.9e-6, 1.0)
    assert not equal(1.0 + 1.1e-6, 1.0)


def test_the_difference_has_both_values() -> None:
    assert difference(1.0, 2.0) == Difference("", 1.0, 2.0)


@pytest.mark.parametrize("tolerance", [-1e-9, math.nan])
def test_a_tolerance_that_is_none_is_the_authors_fault(tolerance: float) -> None:
    with pytest.raises(ValueError, match="a tolerance is a number of 0 or more"):
        equal(1.0, 1.0, tolerance)
