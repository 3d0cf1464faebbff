"""Separates IPython's commands in a cell from its Python code.

The rules are those of IPython's `inputtransformer2`: a command begins a statement, so a line that begins with `%` or
`!` inside a string or a bracket, or that continues the line before, is Python. Line numbers do not change: a
command becomes an empty line, or `pass` in a block, which may need a statement.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

#: What determines where a statement ends: strings, comments, brackets, and continued lines.
_TOKEN = re.compile(
    r"""
    (?P<text>(?:'''(?:\\.|(?!''').)*+(?:'''|\Z)) | (?:\"\"\"(?:\\.|(?!\"\"\").)*+(?:\"\"\"|\Z))
        | '(?:\\.|[^'\\\n])*+'? | "(?:\\.|[^"\\\n])*+"?)
    | (?P<comment>\#[^\n]*) | (?P<open>[(\[{]) | (?P<close>[)\]}]) | (?P<continued>\\\r?\n) | (?P<end>\n)
    """.replace("*+", "*"),
    re.VERBOSE | re.DOTALL,
)
_COMMAND = re.compile(r"[ \t]*(?P<sign>%%?|!!?|\?\??|[,;/])(?P<rest>.*)")
_ASSIGNED = re.compile(r"(?P<target>[\w.,\[\]'\" \t]+=)[ \t]*(?:![^=]|%[ \t]*[A-Za-z])")
_HELP = re.compile(r"[^'\"#]*[\w*\]]\?\??[ \t]*(?:#.*)?$")
_TIMED = re.compile(r"%(?:time|prun)[ \t]+(?P<statement>[^-\s].*)$")
#: Longer lines (characters) are not searched for a command inside them: the patterns would take too long.
_LONGEST = 500
_CELL = re.compile(r"%%(?P<name>\w+)[ \t]*(?P<line>.*)")
_PROMPT = re.compile(r"^(?:>>> ?|\.\.\. ?|In \[\d+\]: ?|[ ]*\.\.\.: ?)")
#: Commands that IPython understands without their `%`.
_AUTOMAGIC = re.compile(r"(?:pip|conda|mamba|uv|cd|ls|pwd|mkdir|cat|cp|mv|rm)(?:[ \t]+[^=\s(.\[,:].*)?$")


@dataclass(frozen=True)
class Magic:
    """A cell's magic, `%%name line`, and the code below it. `name` is "" for an ordinary cell.

    `code` has as many lines as the cell; the line with the magic is empty.
    """

    name: str
    line: str
    code: str


def cell_magic(source: str) -> Magic:
    """Split a cell's magic from its code. Empty lines and comments above the magic do not matter."""
    lines = _without_indentation(source.replace("\r\n", "\n").split("\n"))
    for number, line in enumerate(lines):
        if match := _CELL.fullmatch(line.rstrip()):
            return Magic(match["name"], match["line"], "\n" * (number + 1) + "\n".join(lines[number + 1 :]))
        if line.strip() and not line.lstrip().startswith("#"):
            break
    return Magic("", "", "\n".join(_without_prompts(lines)))


def _without_prompts(lines: list[str]) -> list[str]:
    first = next((line for line in lines if line.strip()), "")
    return [_PROMPT.sub("", line) for line in lines] if _PROMPT.match(first) else lines


def _without_indentation(lines: list[str]) -> list[str]:
    first = next((line for line in lines if line.strip()), "")
    return [line.removeprefix(first[: len(first) - len(first.lstrip())]) for line in lines]


def without_commands(code: str, automagic: bool = False) -> str:
    """Return the code without the notebook's commands. With `automagic`, also without those that lack their `%`."""
    lines = code.split("\n")
    for first, last in _commands(code, automagic):
        text = "\n".join(lines[first : last + 1])
        lines[first] = _replacement(text)
        lines[first + 1 : last + 1] = [""] * (last - first)
    return "\n".join(lines)


def _replacement(text: str) -> str:
    bare = text.lstrip()
    indent = text[: len(text) - len(bare)]
    if match := _ASSIGNED.match(bare):
        return f"{indent}{match['target']} None"
    if match := _TIMED.match(bare):
        return indent + match["statement"]
    return f"{indent}pass" if indent else ""


def _commands(code: str, automagic: bool) -> Iterator[tuple[int, int]]:
    """Yield the first and the last line of each command, counted from 0."""
    position, line, depth, begins = 0, 0, 0, True
    while position <= len(code):
        if begins:
            if length := _command(code, position, automagic):
                text = code[position : position + length]
                yield line, line + text.count("\n")
                line += text.count("\n") + 1
                position += length + 1
                continue
            begins = False
        token = _TOKEN.search(code, position)
        if token is None:
            return
        depth += bool(token["open"]) - bool(token["close"] and depth)
        line += token[0].count("\n")
        begins = bool(token["end"]) and not depth
        position = token.end()


def _command(code: str, position: int, automagic: bool) -> int:
    """Return the length of the command that begins here; 0 if it is a Python statement."""
    text = _line(code, position)
    if _COMMAND.match(text):
        length = len(text)
        while code[position + length - 1] == "\\" and position + length < len(code):
            length += 1 + len(_line(code, position + length + 1))
        return length
    if len(text) > _LONGEST:
        return 0
    bare = text.strip()
    if _ASSIGNED.match(bare) or _HELP.match(bare) or (automagic and _AUTOMAGIC.match(bare)):
        return len(text)
    return 0


def _line(code: str, position: int) -> str:
    end = code.find("\n", position)
    return code[position : end if end >= 0 else len(code)]
