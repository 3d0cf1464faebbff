"""Makes a student's text harmless for terminals and pictures."""

from __future__ import annotations

import unicodedata

#: Line ends and tabs; in names: Japanese spaces, joiners, and marks of the direction in which a word is written.
KEPT = "\n\t\u3000\u200c\u200d\u200e\u200f"


def printable(text: str, longest: int = 0) -> str:
    """Return `text` with every character that could control a terminal replaced; line ends and tabs stay.

    An invisible character is shown as `<U+200B>`. With `longest`, keep only this many characters.
    """
    shown = "".join(c if c.isprintable() or c in KEPT else _visible(c) for c in text)
    return shown if not longest or len(shown) <= longest else f"{shown[:longest]}…"


def _visible(char: str) -> str:
    return f"<U+{ord(char):04X}>" if unicodedata.category(char) in ("Cf", "Zs") else "\N{REPLACEMENT CHARACTER}"
