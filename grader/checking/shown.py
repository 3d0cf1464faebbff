"""Values in the words of a finding."""

from __future__ import annotations

from typing import Any

#: So many elements of a list are shown, and so many characters of anything else.
MOST_ELEMENTS, MOST_CHARACTERS = 8, 200


def shown(value: Any, unit: str = "") -> str:
    """A value for people: `0.25 rad/s`, `[1, 2, 3 …]`, a stamp as `100.250000000`."""
    if isinstance(value, float):
        return f"{value:.6g}{f' {unit}' if unit else ''}"
    if isinstance(value, dict) and set(value) == {"sec", "nanosec"}:
        return f"{value['sec']}.{value['nanosec']:09d}"
    if isinstance(value, dict):
        return ", ".join(f"{name} {shown(part)}" for name, part in value.items())[:MOST_CHARACTERS]
    if isinstance(value, (list, tuple)):
        text = ", ".join(shown(item) for item in value[:MOST_ELEMENTS])
        return f"[{text}{' …' if len(value) > MOST_ELEMENTS else ''}]"
    text = repr(value) if isinstance(value, str) else str(value)
    text += f" {unit}" if unit and isinstance(value, int) and not isinstance(value, bool) else ""
    return text if len(text) < MOST_CHARACTERS else f"{text[:MOST_CHARACTERS]}…"
