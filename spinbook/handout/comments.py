"""Takes HTML comments out of Markdown: nobody sees them on a page, and authors write notes in them."""

from __future__ import annotations

import re

_FENCE = re.compile(r"^ {0,3}(`{3,}|~{3,})(.*)$")
#: Code in a line stays, and with it a comment that is only quoted.
_PART = re.compile(r"(?P<code>`+)(?!`).*?(?<!`)(?P=code)(?!`)|<!--(?P<comment>.*?)(?P<end>-->|$)")


def without_comments(markdown: str, *, keep_lines: bool = False) -> str:
    """`markdown` without comments; what stands in code is no comment.

    A line that held nothing else is left out, or, with `keep_lines`, left empty, so that lines keep their numbers.
    """
    out: list[str] = []
    fence = ""
    inside = False
    for line in markdown.split("\n"):
        if inside:
            _, ended, line = line.partition("-->")
            inside = not ended
            if not line.strip():
                out += [""] if keep_lines else []
                continue
        elif match := _FENCE.match(line):
            mark, info = match.groups()
            if not fence:
                fence = mark
            elif mark.startswith(fence) and not info.strip():
                fence = ""
            out.append(line)
            continue
        if fence:
            out.append(line)
            continue
        shown, inside = _shown(line)
        if shown.strip() or not line.strip() or keep_lines:
            out.append(shown)
    return "\n".join(out)


def _shown(line: str) -> tuple[str, bool]:
    """What of a line is shown, and whether a comment goes on in the next."""
    goes_on = False

    def replaced(match: re.Match[str]) -> str:
        nonlocal goes_on
        if match["code"]:
            return match[0]
        goes_on = not match["end"]
        return ""

    return _PART.sub(replaced, line), goes_on
