"""Joins what a cell printed piece by piece, in a time that grows with its length only."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any


def joined(outputs: Iterable[Any]) -> list[Any]:
    """Return a cell's outputs with one stream each for stdout and stderr, where the first piece was, stdout first."""
    kept: list[Any] = []
    texts: dict[str, list[str]] = {}
    for output in outputs:
        if output["output_type"] == "stream":
            if output["name"] not in texts:
                kept.append(output)
            texts.setdefault(output["name"], []).append("".join(output["text"]))
        else:
            kept.append(output)
    for output in kept:
        if output["output_type"] == "stream":
            output["text"] = as_in_a_terminal("".join(texts[output["name"]]))
    return _stdout_first(kept)


def _stdout_first(outputs: list[Any]) -> list[Any]:
    """Put stdout before stderr if they are neighbours: they arrive in no particular order."""
    names = [output.get("name") if output["output_type"] == "stream" else None for output in outputs]
    for at in range(len(outputs) - 1):
        if names[at : at + 2] == ["stderr", "stdout"]:
            outputs[at : at + 2] = [outputs[at + 1], outputs[at]]
            break
    return outputs


def as_in_a_terminal(text: str) -> str:
    """Return the text after its carriage returns and backspaces have had their effect.

    >>> as_in_a_terminal("10 %\\r20 %\\nab\\bc\\n")
    '20 %\\nac\\n'
    """
    if "\r" not in text and "\b" not in text:
        return text
    return "\n".join(map(_line, text.split("\n")))


def _line(line: str) -> str:
    """Return the visible part of a line: what comes after its last carriage return, without what was erased."""
    shown: list[str] = []
    for letter in line.rstrip("\r").rpartition("\r")[2]:
        if letter == "\b":
            del shown[-1:]
        else:
            shown.append(letter)
    return "".join(shown)
