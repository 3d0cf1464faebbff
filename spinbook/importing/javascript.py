"""Reads the literals in a file of JavaScript or TypeScript, without running it: objects, lists, texts."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

_TOKEN = re.compile(
    r"""\s+|//[^\n]*|/\*.*?\*/|(?P<string>"(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])*'|`(?:\\.|[^`\\])*`)|(?P<mark>[{}\[\],:])"""
    r"""|(?P<word>[^\s"'`{}\[\],:/]+|/)""",
    re.DOTALL,
)
_OBJECT = re.compile(r"(?:=|\bexport\s+default)\s*(?=\{)")


def objects_in(text: str) -> Iterator[Any]:
    """Yield the objects that a file assigns or exports."""
    for match in _OBJECT.finditer(text):
        tokens = list(_tokens(text[match.end() :]))
        value, _ = _value(tokens, 0)
        yield value


def value_in(text: str) -> Any:
    """Return the value with which a text begins; None for anything but a literal."""
    return _value(list(_tokens(text)), 0)[0]


def _tokens(text: str) -> Iterator[tuple[str, str]]:
    depth = 0
    for match in _TOKEN.finditer(text):
        kind = match.lastgroup
        if kind is None:
            continue
        yield kind, match[0][1:-1] if kind == "string" else match[0]
        depth += (match[0] in "{[") - (match[0] in "}]") if kind == "mark" else 0
        if depth == 0:
            return


def _value(tokens: list[tuple[str, str]], at: int) -> tuple[Any, int]:
    """Return the value that begins at a token, and the index after it. Anything but a literal is None."""
    kind, text = tokens[at] if at < len(tokens) else ("mark", "}")
    if (kind, text) == ("mark", "{"):
        return _object(tokens, at + 1)
    if (kind, text) == ("mark", "["):
        return _list(tokens, at + 1)
    if kind == "string":
        return text, at + 1
    words = ""
    while at < len(tokens) and not (tokens[at][0] == "mark" and tokens[at][1] in ",}]"):
        words += tokens[at][1]
        at += 1
    return {"true": True, "false": False}.get(words), at


def _object(tokens: list[tuple[str, str]], at: int) -> tuple[dict[str, Any], int]:
    found: dict[str, Any] = {}
    while at < len(tokens) and tokens[at] != ("mark", "}"):
        key, at = tokens[at][1], at + 1
        if at < len(tokens) and tokens[at] == ("mark", ":"):
            found[key], at = _value(tokens, at + 1)
    return found, at + 1


def _list(tokens: list[tuple[str, str]], at: int) -> tuple[list[Any], int]:
    found: list[Any] = []
    while at < len(tokens) and tokens[at] != ("mark", "]"):
        if tokens[at] == ("mark", ","):
            at += 1
            continue
        before = at
        value, at = _value(tokens, at)
        found.append(value)
        at += at == before
    return found, at + 1
