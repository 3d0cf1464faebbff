"""Words in messages."""

from __future__ import annotations


def counted(number: int, noun: str) -> str:
    """Return `1 student` or `2 students`, `1 entry` or `2 entries`."""
    if number == 1:
        return f"1 {noun}"
    if noun.endswith("y") and noun[-2] not in "aeou":
        return f"{number} {noun[:-1]}ies"
    return f"{number} {noun}s"
