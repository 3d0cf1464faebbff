"""Turtlesim's canvas without numpy: draws the same pixels as ros_in_python/turtlesim/canvas.py, one by one."""

from __future__ import annotations

import math

from ros_in_python.turtlesim import canvas
from ros_in_python.turtlesim.events import PIXELS_PER_UNIT, WINDOW_PX, Pen

_PIXEL = 3


class PlainCanvas:
    """500 by 500 pixels; x to the right and y down. Unpainted ones are white."""

    def __init__(self) -> None:
        self.clear()

    def clear(self) -> None:
        """Make every pixel white again."""
        self._pixels = bytearray(b"\xff" * (WINDOW_PX * WINDOW_PX * _PIXEL))

    def color(self, point: canvas.Point) -> tuple[int, int, int]:
        """Return red, green and blue (0..255) of the pixel at `point` (units, y down)."""
        column, row = (math.floor(part * PIXELS_PER_UNIT + 0.5) for part in point)
        if not (0 <= column < WINDOW_PX and 0 <= row < WINDOW_PX):
            return (0, 0, 0)
        at = (row * WINDOW_PX + column) * _PIXEL
        red, green, blue = self._pixels[at : at + _PIXEL]
        return (red, green, blue)

    def line(self, start: canvas.Point, end: canvas.Point, pen: Pen) -> None:
        """Draw a straight line with square caps from `start` to `end` (units, y down)."""
        near, far = sorted((start, end), key=lambda point: math.hypot(*point))
        x0, y0, x1, y1 = (part * PIXELS_PER_UNIT for part in (*near, *far))
        half = pen.width / 2
        length = math.hypot(x1 - x0, y1 - y0)
        along_x, along_y = ((x1 - x0) / length, (y1 - y0) / length) if length else (1.0, 0.0)
        reach = half * math.sqrt(2)
        paint = bytes((pen.r, pen.g, pen.b))
        for row in _pixels(min(y0, y1) - reach, max(y0, y1) + reach):
            for column in _pixels(min(x0, x1) - reach, max(x0, x1) + reach):
                along = (column - x0) * along_x + (row - y0) * along_y
                across = (row - y0) * along_x - (column - x0) * along_y
                if -half <= along <= length + half and abs(across) <= half:
                    at = (row * WINDOW_PX + column) * _PIXEL
                    self._pixels[at : at + _PIXEL] = paint


def _pixels(low: float, high: float) -> range:
    """Return the pixels from `low` to `high` that are on the canvas."""
    return range(math.floor(min(max(low, 0), WINDOW_PX)), math.ceil(min(max(high + 1, 0), WINDOW_PX)))


def use() -> None:
    """Make turtlesim draw on this canvas. Call this before its other modules are imported."""
    canvas.Canvas = PlainCanvas  # type: ignore[misc, assignment]
