"""Prints on terminals and into files of any encoding: what an encoding lacks is written with other characters."""

from __future__ import annotations

import codecs
import io
import sys

#: What stands for a character that an encoding such as ASCII lacks; for others, it is "?".
_PLAIN = {
    **{"✓": "+", "✗": "x", "○": "o", "●": "*", "·": "*", "×": "x", "→": "->", "←": "<-", "…": "..."},
    **{"—": "-", "–": "-", "─": "-", "│": "|", "━": "-", "“": '"', "”": '"', "‘": "'", "’": "'", "\u00a0": " "},
    **{"≤": "<=", "≥": ">=", "≠": "!=", "±": "+-", "°": " deg", "π": "pi", "█": "#"},
}


def print_in_any_encoding() -> None:
    """Let this process print every text, whatever `PYTHONIOENCODING`, `LANG` or a pipe's encoding is."""
    codecs.register_error("plain", _plain)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="plain")


def _plain(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return "".join(_PLAIN.get(character, "?") for character in error.object[error.start : error.end]), error.end
