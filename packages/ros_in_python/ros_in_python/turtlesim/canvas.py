"""The image on which the turtles draw, as their colour sensors see it."""

from __future__ import annotations

import math

from ros_in_python.turtlesim.events import PIXELS_PER_UNIT, WINDOW_PX, Pen

Point = tuple[float, float]
#: Bytes of a pixel: red, green, blue.
_PIXEL = 3
#: A pixel whose centre is on the edge of a line is painted, whichever way its numbers were rounded.
_ROUNDING = 1e-9


class Canvas:
    """500 by 500 pixels, 45 per unit; x to the right and y down from the upper left corner.

    Unpainted pixels read white, as they do in turtlesim, whose canvas is transparent white over the background.
    A pixel's centre is at whole numbers, so that a turtle is always on the pixel nearest to it.
    """

    def __init__(self) -> None:
        self.clear()

    def clear(self) -> None:
        """Make every pixel white again."""
        self._pixels = bytearray(b"\xff" * (WINDOW_PX * WINDOW_PX * _PIXEL))

    def color(self, point: Point) -> tuple[int, int, int]:
        """Return red, green and blue (0..255) of the pixel at `point` (units, y down)."""
        column, row = (math.floor(part * PIXELS_PER_UNIT + 0.5) for part in point)
        if not (0 <= column < WINDOW_PX and 0 <= row < WINDOW_PX):
            return (0, 0, 0)
        at = (row * WINDOW_PX + column) * _PIXEL
        r, g, b = self._pixels[at : at + _PIXEL]
        return (r, g, b)

    def line(self, start: Point, end: Point, pen: Pen) -> None:
        """Draw a straight line with square caps from `start` to `end` (units, y down)."""
        # Measured from the end that is nearer to the canvas: the other may be too far away to be exact.
        near, far = sorted((start, end), key=lambda point: math.hypot(*point))
        x0, y0, x1, y1 = (part * PIXELS_PER_UNIT for part in (*near, *far))
        half, length = pen.width / 2, math.hypot(x1 - x0, y1 - y0)
        along_x, along_y = ((x1 - x0) / length, (y1 - y0) / length) if length else (1.0, 0.0)
        # A cap's corner lies up to sqrt(2) of half the width away.
        reach = half * math.sqrt(2)
        for row in _pixels(min(y0, y1) - reach, max(y0, y1) + reach):
            dy = row - y0
            caps = _factors(-half - dy * along_y, length + half - dy * along_y, along_x)
            sides = _factors(dy * along_x - half, dy * along_x + half, along_y)
            columns = _pixels(x0 + max(caps[0], sides[0]), x0 + min(caps[1], sides[1]))
            at = (row * WINDOW_PX + columns.start) * _PIXEL
            self._pixels[at : at + len(columns) * _PIXEL] = bytes((pen.r, pen.g, pen.b)) * len(columns)


def _factors(low: float, high: float, of: float) -> tuple[float, float]:
    """Return the least and the greatest number that `of` times is from `low` to `high`; there may be none or no end."""
    if not of:
        return (-math.inf, math.inf) if low <= 0 <= high else (math.inf, -math.inf)
    least, greatest = sorted((low / of, high / of))
    return least, greatest


def _pixels(low: float, high: float) -> range:
    """Return the pixels from `low` to `high` that are on the canvas; there may be none."""
    first = math.ceil(min(max(low, 0), WINDOW_PX) - _ROUNDING)
    last = math.floor(max(min(high, WINDOW_PX - 1), -1) + _ROUNDING)
    return range(first, max(first, last + 1))
