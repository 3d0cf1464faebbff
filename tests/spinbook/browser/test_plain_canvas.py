"""Turtlesim's canvas without numpy paints the pixels that the one with numpy paints."""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st

from ros_in_python.turtlesim.canvas import Canvas
from ros_in_python.turtlesim.events import Pen
from spinbook.browser.in_page.canvas import PlainCanvas

PLACES = st.tuples(st.floats(-1, 12), st.floats(-1, 12))
PENS = st.builds(Pen, r=st.integers(0, 255), g=st.integers(0, 255), b=st.integers(0, 255), width=st.integers(1, 20))


@settings(max_examples=25, deadline=None)
@given(st.lists(st.tuples(PLACES, PLACES, PENS), max_size=2), st.lists(PLACES, min_size=5, max_size=30))
def test_the_same_pixels_are_painted(
    lines: list[tuple[tuple[float, float], tuple[float, float], Pen]], places: list[tuple[float, float]]
) -> None:
    plain, real = PlainCanvas(), Canvas()
    for start, end, pen in lines:
        plain.line(start, end, pen)
        real.line(start, end, pen)
        middle = ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2)
        for place in (*places, start, end, middle):
            assert plain.color(place) == real.color(place)
