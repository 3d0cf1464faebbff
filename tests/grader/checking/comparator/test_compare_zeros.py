"""-0.0 equals 0.0: correct arithmetic gives either."""

from __future__ import annotations

import pytest

from grader.checking.comparator import equal


@pytest.mark.parametrize("tolerance", [0.0, 1e-6])
@pytest.mark.parametrize(("got", "expected"), [(-0.0, 0.0), (-0.0, -0.0), (0.0, 0), (-0.0, 0), ([-0.0], [0.0])])
def test_signed_zeros(got: object, expected: object, tolerance: float) -> None:
    assert equal(got, expected, tolerance)
    assert equal(expected, got, tolerance)
