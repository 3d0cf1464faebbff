"""NaN equals NaN and nothing else; an infinity equals the infinity of its sign and nothing else."""

from __future__ import annotations

import math
import struct

import pytest

from grader.checking.comparator import equal

NAN, INF = math.nan, math.inf
OTHER_NAN = struct.unpack("<d", struct.pack("<Q", 0xFFF8_0000_0000_1234))[0]


@pytest.mark.parametrize("tolerance", [0.0, 1e-6, 1e9])
@pytest.mark.parametrize(
    ("got", "expected", "same"),
    [
        (NAN, NAN, True),
        (OTHER_NAN, NAN, True),
        (NAN, 0.0, False),
        (NAN, 1, False),
        (NAN, INF, False),
        (NAN, None, False),
        (INF, INF, True),
        (-INF, -INF, True),
        (INF, -INF, False),
        (INF, 1.7976931348623157e308, False),
        ([NAN, 1.0], [NAN, 1.0], True),
        ([NAN, 1.0], [1.0, NAN], False),
        ([1.0, -INF], [1.0, INF], False),
        ({"x": NAN}, {"x": NAN}, True),
    ],
)
def test_what_is_not_finite(got: object, expected: object, same: bool, tolerance: float) -> None:
    assert equal(got, expected, tolerance) is same
    assert equal(expected, got, tolerance) is same
