"""Reads the literals in a file of JavaScript or TypeScript, without running it: objects, lists, texts."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence
from typing import Any

import yaml

_TOKEN = re.compile(
    r"""\s+|//[^\n]*|/\*.*?\*/|(?P<string>"(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])*'|`(?:\\.|[^`\\])*`)|(?P<mark>[{}\[\],:])"""
    r"""|(?P<word>[^\s"'`{}\[\],:/]+|/)""",
    re.DOTALL,
)
_OBJECT = re.compile(r"(?:=|\bexport\s+default)\s*(?=\{)")


def objects_in(text: str) -> Iterator[Any]:
    """Yield the objects that a file assigns or exports."""
    return (value_in(text[match.end() :]) for match in _OBJECT.finditer(text))


def value_in(text: str) -> Any:
    """Return the object or list with which a text begins, whatever follows it; None if it isn't a literal.

    Expressions in it are None.
    """
    try:
        return yaml.safe_load(_as_yaml(text))
    except yaml.YAMLError:
        return None


def _as_yaml(text: str) -> str:
    """Return the object or list with which a text begins as YAML, which also has commas before the last bracket."""
    flow, depth, nested, after_colon = "", 0, 0, False
    tokens: list[str] = []
    for match in _TOKEN.finditer(text):
        mark = match["mark"]
        # An expression goes on to the end of its brackets, and after the colon of CONDITION ? ONE : OTHER.
        if not mark or nested or (tokens and mark in "{[") or (mark == ":" and after_colon):
            tokens += [match[0]] if match.lastgroup else []
            nested += sum((sign in "([{") - (sign in ")]}") for sign in mark or match["word"] or "")
            continue
        flow += f"{_scalar(tokens, is_key=mark == ':')}{mark} "
        tokens, after_colon = [], mark == ":"
        depth += (mark in "{[") - (mark in "}]")
        if depth == 0:
            break
    return flow


def _scalar(tokens: Sequence[str], *, is_key: bool) -> str:
    """Return a text, a key, true or false as YAML; an expression is null."""
    is_text = len(tokens) == 1 and tokens[0][0] in "\"'`"
    if is_text or (is_key and tokens):
        return json.dumps(tokens[0][1:-1] if tokens[0][0] in "\"'`" else tokens[0], ensure_ascii=False)
    return tokens[0] if tokens in (["true"], ["false"]) else "null" if tokens else ""
