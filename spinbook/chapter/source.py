"""A chapter's file as text: decoded, with `\n` line ends, without byte-order mark and front matter."""

from __future__ import annotations

import re
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from groundwork.problem import Problem, Severity

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

#: The C version of yaml.SafeLoader is ten times faster.
_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
#: What Jekyll replaces in addresses before it reads Markdown: `{{ site.baseurl }}/a`, `{{ "/a" | relative_url }}`.
_LIQUID = re.compile(
    r"""\{\{-?\s*(?:site\.(?:baseurl|url)|["']([^"'{}]*)["']\s*\|\s*(?:relative|absolute)_url)\s*-?\}\}"""
    r"""|\{%-?\s*(?:link|post_url)\s+(\S+)\s*-?%\}"""
)
_CONTROL = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f\x80-\x9f\u2028\u2029]")


@dataclass(frozen=True)
class Source:
    """A chapter's text with `\\n` line ends. Its front matter's lines are blank, so that lines keep their numbers."""

    text: str
    front_matter: Mapping[str, Any]


def read_source(file: Path, shown_as: Path) -> tuple[Source | None, list[Problem]]:
    """Read a chapter's file. If there is no Source, one of the problems is an error. `shown_as` is the path that
    problems name, usually relative to the course.
    """
    problems: list[Problem] = []
    try:
        data = file.read_bytes()
    except OSError as error:
        fix = "Write the chapter, or remove it from `chapters` in course.toml."
        return None, [Problem(shown_as, None, f"the file can't be read: {error.strerror}.", fix)]
    if data.startswith(b"\xef\xbb\xbf"):
        data = data[3:]
        fix = "It is ignored here, but it confuses other tools: save the file as UTF-8 without BOM."
        wrong = "the file begins with a byte-order mark (BOM)."
        problems.append(Problem(shown_as, 1, wrong, fix, Severity.WARNING))
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        problem = f"byte 0x{data[error.start]:02x} is not UTF-8."
        return None, [*problems, Problem(shown_as, line, problem, "Save the file as UTF-8.")]
    if "\r" in text:
        line = text[: text.index("\r")].count("\n") + 1
        fix = "They are read as if they ended in LF: save the file with LF, or set `* text=auto` in .gitattributes."
        problems.append(Problem(shown_as, line, "lines end as on Windows (CRLF).", fix, Severity.WARNING))
        text = text.replace("\r\n", "\n").replace("\r", "\n")
    for number, content in enumerate(text.split("\n"), start=1):
        if control := _CONTROL.search(content):
            problem = f"control character U+{ord(control.group()):04X} in column {control.start() + 1}."
            fix = "Delete it; it can't be seen, and notebooks and browsers reject it. It is ignored here."
            problems.append(Problem(shown_as, number, problem, fix, Severity.WARNING))
    text = _LIQUID.sub(lambda match: match[1] or (f"/{match[2]}" if match[2] else ""), _CONTROL.sub("", text))
    front_matter, body, front_problems = _split_front_matter(text, shown_as)
    return Source(body, front_matter), problems + front_problems


def _split_front_matter(text: str, file: Path) -> tuple[Mapping[str, Any], str, list[Problem]]:
    lines = text.split("\n")
    fence = lines[0].rstrip()
    if fence not in {"---", "+++"}:
        return {}, text, []
    ends = {"---", "..."} if fence == "---" else {"+++"}
    end = next((i for i, line in enumerate(lines[1:], start=1) if line.rstrip() in ends), None)
    if end is None:
        wrong = "the front matter that begins here never ends."
        fix = f"Close it with a line `{fence}`."
        return {}, "\n" + "\n".join(lines[1:]), [Problem(file, 1, wrong, fix, Severity.WARNING)]
    body = "\n" * (end + 1) + "\n".join(lines[end + 1 :])
    if fence == "+++":
        return _toml("\n".join(lines[1:end])), body, []
    try:
        front_matter = yaml.load("\n".join(lines[1:end]), Loader=_LOADER) or {}
    except yaml.YAMLError as error:
        mark = getattr(error, "problem_mark", None)
        line = 2 + mark.line if mark else 1
        reason = getattr(error, "problem", None) or "it can't be read"
        fix = "Write it as YAML, one `key: value` per line; put a value that holds a colon in quotes."
        problem = Problem(file, line, f"the front matter is not YAML: {reason}.", fix, Severity.WARNING)
        return _simple_lines(lines[1:end]), body, [problem]
    if not isinstance(front_matter, dict):
        wrong = f"the front matter is a {type(front_matter).__name__}, not `key: value` lines."
        fix = "Write for example `title: Nodes and Topics`."
        return {}, body, [Problem(file, 2, wrong, fix, Severity.WARNING)]
    return front_matter, body, []


def _simple_lines(lines: list[str]) -> dict[str, str]:
    """Return the part of invalid YAML front matter that can still be read: its lines `key: value`."""
    read = (line.partition(":") for line in lines if line[:1].isalpha())
    return {key.strip(): value.strip().strip("\"'") for key, colon, value in read if colon}


def _toml(text: str) -> dict[str, Any]:
    try:
        return dict(tomllib.loads(text))
    except tomllib.TOMLDecodeError:
        return {}
