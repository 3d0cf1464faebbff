"""Makes the starter: the solution without the code between its markers."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

BEGIN = re.compile(r"^(\s*)# BEGIN SOLUTION\s*$")
END = re.compile(r"^\s*# END SOLUTION\s*$")


class MarkerError(ValueError):
    """Raised when the markers of a solution don't pair up; `line` counts from 1."""

    def __init__(self, line: int, message: str) -> None:
        super().__init__(f"line {line}: {message}")
        self.line = line


def starter(source: str) -> str:
    """Return `source` without the lines from each `# BEGIN SOLUTION` to its `# END SOLUTION`.

    Everything else stays, so the author's `# TODO` comments above a marker guide the student. A body that would be
    empty gets a `pass`. Raises `MarkerError` if a marker lacks its partner, if there are no markers, or if the rest is
    not valid Python.
    """
    kept: list[str] = []
    begun: tuple[int, str] | None = None
    markers = 0
    for number, line in enumerate(source.removeprefix("\ufeff").splitlines(), start=1):
        if match := BEGIN.match(line):
            if begun:
                raise MarkerError(number, f"BEGIN SOLUTION inside the one of line {begun[0]}")
            begun, markers = (number, match.group(1)), markers + 1
            kept.append(_PLACEHOLDER + match.group(1))
        elif END.match(line):
            if not begun:
                raise MarkerError(number, "END SOLUTION without a BEGIN SOLUTION before it")
            begun = None
        elif not begun:
            kept.append(line)
    if begun:
        raise MarkerError(begun[0], "BEGIN SOLUTION without an END SOLUTION after it")
    if not markers:
        raise MarkerError(1, "no BEGIN SOLUTION marker, so the starter would be the solution")
    result = re.sub(r"\n{4,}", "\n\n\n", "\n".join(_closed(kept))) + "\n"
    try:
        ast.parse(result)
    except SyntaxError as error:
        raise MarkerError(error.lineno or 1, f"the starter made from this is not valid Python: {error.msg}") from None
    return result


def hidden_blocks(source: str) -> Iterator[list[tuple[int, str]]]:
    """Yield the lines of each block between markers, with their numbers, counted from 1."""
    block: list[tuple[int, str]] | None = None
    for number, line in enumerate(source.removeprefix("\ufeff").splitlines(), start=1):
        if BEGIN.match(line):
            block = []
        elif END.match(line):
            yield block or []
            block = None
        elif block is not None:
            block.append((number, line))
    if block:  # a marker that lacks its partner, see `starter`
        yield block


#: Replaces a removed block until it is known whether its body is left empty.
_PLACEHOLDER = "\0"


def _closed(lines: list[str]) -> list[str]:
    """Return `lines` without placeholders, with a `pass` for each removed block whose body has no statement left."""
    result: list[str] = []
    for index, line in enumerate(lines):
        if not line.startswith(_PLACEHOLDER):
            result.append(line)
            continue
        indent = line[len(_PLACEHOLDER) :]
        before = next((text for text in reversed(lines[:index]) if _is_code(text)), "")
        after = next((text for text in lines[index + 1 :] if _is_code(text) or text.startswith(_PLACEHOLDER)), "")
        text = after.removeprefix(_PLACEHOLDER)
        follows = bool(after) and len(text) - len(text.lstrip()) >= len(indent)
        if before.split("#")[0].rstrip().endswith(":") and indent and not follows:
            result.append(f"{indent}pass")
    return result


def _is_code(line: str) -> bool:
    text = line.strip()
    return bool(text) and not text.startswith("#") and not line.startswith(_PLACEHOLDER)
