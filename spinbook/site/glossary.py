"""The glossary: a Markdown file whose headings are the terms."""

from __future__ import annotations

import re
from dataclasses import dataclass

_TERM = re.compile(r"^##\s+(.+?)\s*#*$", re.MULTILINE)
_SHORT = re.compile(r"^(.*?)\s*\(([^)]+)\)$")


@dataclass(frozen=True)
class Term:
    """A term, the ways in which it is written, and its anchor on the glossary's page."""

    title: str
    forms: tuple[str, ...]
    anchor: str


def terms_of(text: str) -> tuple[Term, ...]:
    """The terms of a glossary. `## Quality of service (QoS)` is found in a chapter by both names, and in the plural."""
    return tuple(_term(match.group(1)) for match in _TERM.finditer(text))


def _term(heading: str) -> Term:
    title = heading.replace("`", "")
    short = _SHORT.match(title)
    names = [short.group(1), short.group(2)] if short else [title]
    forms = [form for name in names for form in (name, *_plurals(name))]
    return Term(title, tuple(dict.fromkeys(forms)), anchor_of(title))


def _plurals(name: str) -> tuple[str, ...]:
    return (name[:-1] + "ies",) if name.endswith("y") else (name + "s",)


def anchor_of(title: str) -> str:
    """The id that a heading gets: its words in lower case, with hyphens."""
    return re.sub(r"[^a-z0-9]+", "-", title.lower()).strip("-")
