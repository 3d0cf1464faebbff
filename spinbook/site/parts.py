"""Divides a chapter at its headings into parts of 10 to 20 minutes, which its page shows one at a time.

It stays one document: nodes that run in the page go on, links and the search lead into every part, and paper, a browser
without scripts and "Whole chapter" show them all.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape

from docutils import nodes

from groundwork.words import counted
from spinbook.site.minutes import WORDS_PER_MINUTE

#: Parts take from this to that long, as far as the chapter's headings allow (minutes).
SHORTEST, LONGEST = 10, 20
#: A part that begins within a section must be worth this much.
_WITHIN_COST = 2.0
#: For reading, running and understanding a block of code, if the author says nothing (minutes).
PER_CELL = 2


@dataclass(frozen=True)
class TimedSection:
    """What is not divided any more: a section, or a subsection of a long one, `within` the section of that title."""

    title: str
    minutes: float
    node: nodes.section
    within: str = ""


def divide(document: nodes.document, minutes: Mapping[str, int]) -> None:
    """Divide a chapter. `minutes` are the author's, by the sections' anchors; other sections are estimated."""
    top = next(document.findall(nodes.section), None)
    sections = [child for child in top.children if isinstance(child, nodes.section)] if top else []
    parts = _parts([timed for section in sections for timed in _timed(section, minutes)])
    if top is None or len(parts) < 2:
        return
    at = top.index(sections[0])
    title, *before = top.children[:at]
    rest = [child for child in top.children[at:] if child not in sections]
    top.children = [title, _raw(_numbers(parts))]
    for number, part in enumerate(parts, 1):
        top.append(_raw(_opening(number, parts)))
        top.extend(before if number == 1 else [])
        top.extend(section.node for section in part)
        top.extend(rest if number == len(parts) else [])
        top.append(_raw(f"{_steps(number, parts)}</div>"))


def _parts(sections: Sequence[TimedSection]) -> list[list[TimedSection]]:
    """Group neighbours so that parts are hardly ever shorter or longer than they should be, and alike in length."""
    best: list[tuple[float, list[list[TimedSection]]]] = [(0.0, [])]
    for end in range(1, len(sections) + 1):
        groups = [(cost, parts, list(sections[start:end])) for start, (cost, parts) in enumerate(best)]
        ways = [(cost + _cost(group), [*parts, group]) for cost, parts, group in groups]
        best.append(min(ways, key=lambda way: way[0]))
    return best[-1][1]


def _cost(part: list[TimedSection]) -> float:
    minutes = _minutes(part)
    outside = max(SHORTEST - minutes, minutes - LONGEST, 0)
    uneven = (minutes - (SHORTEST + LONGEST) / 2) / LONGEST
    return float(outside**2 + uneven**2 + (_WITHIN_COST if part[0].within else 0))


def _timed(section: nodes.section, minutes: Mapping[str, int]) -> Iterator[TimedSection]:
    """Yield a section, or, if it takes too long, its beginning and each of its subsections."""
    estimated = _estimate(section)
    known = next((minutes[anchor] for anchor in section["ids"] if anchor in minutes), None)
    total = estimated if known is None else float(known)
    inner = [child for child in section.children if isinstance(child, nodes.section)]
    scale = total / max(estimated, 1)
    # A beginning that is too short for a part keeps the first subsection.
    is_short = scale * (estimated - sum(map(_estimate, inner))) < SHORTEST
    later = inner[1:] if is_short else inner
    if total <= LONGEST or not later:
        yield TimedSection(_title(section), total, section)
        return
    for child in later:
        section.remove(child)
    yield TimedSection(_title(section), scale * _estimate(section), section)
    for child in later:
        # The heading keeps its level within a section that has no heading of its own.
        yield TimedSection(_title(child), scale * _estimate(child), nodes.section("", child), _title(section))


def _estimate(section: nodes.section) -> float:
    words = sum(len(text.astext().split()) for text in section.findall(nodes.paragraph))
    cells = sum(bool(node.get("nb_element") == "cell_code") for node in section.findall(nodes.container))
    return words / WORDS_PER_MINUTE + PER_CELL * cells


def _minutes(part: list[TimedSection]) -> float:
    return sum(section.minutes for section in part)


def _title(section: nodes.section) -> str:
    return next((child.astext() for child in section.children if isinstance(child, nodes.title)), "")


def _about(part: list[TimedSection]) -> str:
    return counted(max(1, round(_minutes(part))), "minute")


def _numbers(parts: list[list[TimedSection]]) -> str:
    """Return the links to all parts, above the first one."""
    links = "".join(
        f'<li><a href="#part-{number}" aria-label="Page {number}: {escape(part[0].title)}">{number}</a></li>'
        for number, part in enumerate(parts, 1)
    )
    return (
        f'<nav class="pages" aria-label="Pages of this chapter"><ol>{links}</ol>'
        '<button type="button" class="whole" aria-pressed="false">Whole chapter</button></nav>'
    )


def _opening(number: int, parts: list[list[TimedSection]]) -> str:
    hidden = ' hidden="until-found"' if number > 1 else ""
    place = f"Page {number} of {len(parts)}"
    within = parts[number - 1][0].within
    # Headings leave out no level, wherever a part begins.
    continued = f'<h2 class="part-within">{escape(within)}, continued</h2>' if within else ""
    return (
        f'<div class="part" id="part-{number}" role="group" aria-label="{place}" tabindex="-1"{hidden}>'
        f'<p class="part-place">{place} · about {_about(parts[number - 1])}</p>{continued}'
    )


def _steps(number: int, parts: list[list[TimedSection]]) -> str:
    """Return the links to the parts before and after."""
    links = ""
    for name, other in (("before", number - 1), ("after", number + 1)):
        if 1 <= other <= len(parts):
            words = f"<span>Page {other} · {_about(parts[other - 1])}</span> {escape(parts[other - 1][0].title)}"
            links += f'<a class="step-{name}" href="#part-{other}">{words}</a>'
    return f'<nav class="steps" aria-label="Before and after page {number}">{links}</nav>'


def _raw(html: str) -> nodes.raw:
    return nodes.raw("", html, format="html")
