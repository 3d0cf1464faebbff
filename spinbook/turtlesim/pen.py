"""The pen with which a turtle draws."""

from __future__ import annotations

from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Pen:
    """Colour (each part 0..255), width in pixels of the window, and whether it is lifted."""

    r: int = 179
    g: int = 184
    b: int = 255
    width: int = 3
    off: bool = False

    def changed(self, r: int, g: int, b: int, width: int, off: int) -> Pen:
        """The pen after a set_pen request: lifting keeps the colour, and a width of 0 means 1."""
        if off:
            return replace(self, off=True)
        return Pen(r, g, b, width or 1)
