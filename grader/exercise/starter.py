"""The starter is the solution without what stands between its marks."""

from __future__ import annotations

import ast
import re

BEGIN = re.compile(r"^(\s*)# BEGIN SOLUTION\s*$")
END = re.compile(r"^\s*# END SOLUTION\s*$")


class MarkerError(ValueError):
    """Raised when the marks of a solution don't pair up; `line` counts from 1."""

    def __init__(self, line: int, message: str) -> None:
        super().__init__(f"line {line}: {message}")
        self.line = line


def starter(source: str) -> str:
    """`source` without the lines from each `# BEGIN SOLUTION` to its `# END SOLUTION`.

    Everything else stays as it stands, so the author's `# TODO` comments above a mark lead the student. A body
    that would be left empty gets a `pass`. Raises `MarkerError` when a mark lacks its partner, when there is none
    at all, or when what is left is no Python.
    """
    kept: list[str] = []
    begun: tuple[int, str] | None = None
    marks = 0
    for number, line in enumerate(source.splitlines(), start=1):
        if match := BEGIN.match(line):
            if begun:
                raise MarkerError(number, f"BEGIN SOLUTION inside the one of line {begun[0]}")
            begun, marks = (number, match.group(1)), marks + 1
            kept.append(_PLACE + match.group(1))
        elif END.match(line):
            if not begun:
                raise MarkerError(number, "END SOLUTION without a BEGIN SOLUTION before it")
            begun = None
        elif not begun:
            kept.append(line)
    if begun:
        raise MarkerError(begun[0], "BEGIN SOLUTION without an END SOLUTION after it")
    if not marks:
        raise MarkerError(1, "no BEGIN SOLUTION mark, so the starter would be the solution")
    result = re.sub(r"\n{4,}", "\n\n\n", "\n".join(_closed(kept))) + "\n"
    try:
        ast.parse(result)
    except SyntaxError as error:
        raise MarkerError(error.lineno or 1, f"the starter made from this is not valid Python: {error.msg}") from None
    return result


#: Stands in for a removed block until it is known whether its body is left empty.
_PLACE = "\0"


def _closed(lines: list[str]) -> list[str]:
    """`lines` with a `pass` for each removed block whose body holds no statement any more, and no place marks."""
    result: list[str] = []
    for index, line in enumerate(lines):
        if not line.startswith(_PLACE):
            result.append(line)
            continue
        indent = line[len(_PLACE) :]
        before = next((text for text in reversed(lines[:index]) if _is_code(text)), "")
        after = next((text for text in lines[index + 1 :] if _is_code(text) or text.startswith(_PLACE)), "")
        text = after.removeprefix(_PLACE)
        follows = bool(after) and len(text) - len(text.lstrip()) >= len(indent)
        if before.split("#")[0].rstrip().endswith(":") and indent and not follows:
            result.append(f"{indent}pass")
    return result


def _is_code(line: str) -> bool:
    text = line.strip()
    return bool(text) and not text.startswith("#") and not line.startswith(_PLACE)
