"""The image on which the turtles draw, as their colour sensors see it."""

from __future__ import annotations

import math

import numpy as np

from ros_in_python.turtlesim.events import PIXELS_PER_UNIT, WINDOW_PX, Pen

Point = tuple[float, float]


class Canvas:
    """500 by 500 pixels, 45 per unit; x to the right and y down from the upper left corner.

    Unpainted pixels read white, as they do in turtlesim, whose canvas is transparent white over the background.
    A pixel's centre is at whole numbers, so that a turtle is always on the pixel nearest to it.
    """

    def __init__(self) -> None:
        self._pixels = np.full((WINDOW_PX, WINDOW_PX, 3), 255, dtype=np.uint8)

    def clear(self) -> None:
        """Make every pixel white again."""
        self._pixels.fill(255)

    def color(self, point: Point) -> tuple[int, int, int]:
        """Return red, green and blue (0..255) of the pixel at `point` (units, y down)."""
        column, row = (math.floor(part * PIXELS_PER_UNIT + 0.5) for part in point)
        if not (0 <= column < WINDOW_PX and 0 <= row < WINDOW_PX):
            return (0, 0, 0)
        r, g, b = self._pixels[row, column].tolist()
        return (r, g, b)

    def line(self, start: Point, end: Point, pen: Pen) -> None:
        """Draw a straight line with square caps from `start` to `end` (units, y down)."""
        # Measured from the end that is nearer to the canvas: the other may be too far away to be exact.
        near, far = sorted((start, end), key=lambda point: math.hypot(*point))
        x0, y0, x1, y1 = (part * PIXELS_PER_UNIT for part in (*near, *far))
        half = pen.width / 2
        # A cap's corner lies up to sqrt(2) of half the width away.
        reach = half * math.sqrt(2)
        columns = _pixel_range(min(x0, x1) - reach, max(x0, x1) + reach)
        rows = _pixel_range(min(y0, y1) - reach, max(y0, y1) + reach)
        length = math.hypot(x1 - x0, y1 - y0)
        along_x, along_y = ((x1 - x0) / length, (y1 - y0) / length) if length else (1.0, 0.0)
        dx = np.arange(columns.start, columns.stop)[np.newaxis, :] - x0
        dy = np.arange(rows.start, rows.stop)[:, np.newaxis] - y0
        along = dx * along_x + dy * along_y
        across = dy * along_x - dx * along_y
        inside = (along >= -half) & (along <= length + half) & (np.abs(across) <= half)
        self._pixels[rows, columns][inside] = (pen.r, pen.g, pen.b)


def _pixel_range(low: float, high: float) -> slice:
    """Return the pixels from `low` to `high` that are on the canvas; there may be none."""
    start = math.floor(min(max(low, 0), WINDOW_PX))
    stop = math.ceil(min(max(high + 1, 0), WINDOW_PX))
    return slice(start, max(start, stop))
