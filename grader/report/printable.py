"""Makes a student's text harmless for terminals and pictures."""

from __future__ import annotations


def printable(text: str, longest: int = 0) -> str:
    """Return `text` with every character that could control a terminal replaced; line ends and tabs stay.

    With `longest`, keep only this many characters.
    """
    shown = "".join(c if c.isprintable() or c in "\n\t" else "\N{REPLACEMENT CHARACTER}" for c in text)
    return shown if not longest or len(shown) <= longest else f"{shown[:longest]}…"
