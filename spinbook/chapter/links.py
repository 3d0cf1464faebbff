"""Finds and replaces the targets of links and images in Markdown as markdown-it parses them: never in code.

markdown-it parses; wrappers around its rules for links, images and HTML record where each target is in the text.
"""

from __future__ import annotations

import functools
import itertools
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape, unescape
from html.parser import HTMLParser
from types import MappingProxyType
from typing import Any

from markdown_it import MarkdownIt
from markdown_it.common.utils import normalizeReference
from markdown_it.rules_inline import StateInline
from markdown_it.token import Token

#: (target, whether it is an image) -> the new target, or None to leave it.
Target = Callable[[str, bool], str | None]
_ATTRIBUTES = {"img": "src", "a": "href", "source": "src", "video": "src"}

_SIZE = re.compile(r"""\b(width|height)\s*[=:]\s*(?:([\w.%]+)|["']([^"']+)["'])""")


@dataclass(frozen=True)
class _LinkTarget:
    """A target in an inline token's content: from `start` to `end`.

    With `is_html`, the target is all of a tag; with `is_reference`, what is there is the `[label]` of a definition that
    is elsewhere, with this title.
    """

    start: int
    end: int
    target: str
    is_image: bool
    is_html: bool = False
    is_reference: bool = False
    title: str = ""


@functools.cache
def _parser() -> MarkdownIt:
    md = MarkdownIt("commonmark", {"html": True}).enable("table")
    md.core.ruler.enableOnly(["normalize", "block"])
    for name in ("link", "image"):
        watch(md, name, _targets)
    watch(md, "html_inline", lambda state, start, _: [_tag(state.src[start : state.pos], start)])
    return md


def _tag(html: str, start: int) -> _LinkTarget:
    return _LinkTarget(start, start + len(html), html, False, is_html=True)


def watch(md: MarkdownIt, name: str, read: Callable[[StateInline, int, int], Iterable[Any]]) -> None:
    """Let the rule `name` add to `env["found"]` what `read` finds in the text `env["watched"]`.

    `read` gets the state, where the rule began, and how many tokens there were before it.
    """
    rule: Any = next(rule.fn for rule in md.inline.ruler.__rules__ if rule.name == name)

    def watched(state: StateInline, silent: bool) -> bool:
        start, before = state.pos, len(state.tokens)
        if not rule(state, silent):
            return False
        if not silent and state.src == state.env.get("watched"):
            state.env["found"].extend(read(state, start, before))
        return True

    md.inline.ruler.at(name, watched)


def _targets(state: StateInline, start: int, before: int) -> Iterator[_LinkTarget]:
    """Yield what may have to be replaced in the link or image that begins at `start` and was parsed just now."""
    token = next(item for item in state.tokens[before:] if item.type in {"image", "link_open"})
    is_image = token.type == "image"
    attributes = _attribute_list(state)
    end = state.pos + len(attributes)
    size = " ".join(f'{name}="{width or quoted}"' for name, width, quoted in _SIZE.findall(attributes))
    if is_image and size:
        html = f'<img src="{escape(str(token.attrs["src"]))}" alt="{escape(token.content)}" {size}>'
        yield _LinkTarget(start, end, html, is_image, is_html=True)
        return
    if place := _destination(state, start + is_image, token):
        yield place
    if attributes:
        yield _LinkTarget(state.pos, end, "", False)


def _destination(state: StateInline, label: int, token: Token) -> _LinkTarget | None:
    """Return the place of `target` in `[text](target "title")`, or of `[label]` in a reference that has to change."""
    # Links in links are not allowed, but images are: the end of the label must be searched again.
    pos, is_image = state.pos, token.type == "image"
    label_end = state.md.helpers.parseLinkLabel(state, label, not is_image)
    state.pos = pos
    at = label_end + 1
    if label_end < 0:
        return None
    if state.src[at : at + 1] != "(":
        name = state.src[at + 1 : pos - 1] or state.src[label + 1 : label_end]
        target = str(token.attrs.get("src") or token.attrs.get("href") or "")
        is_local = normalizeReference(name) in state.env["local"]
        place = _LinkTarget(at, pos, target, is_image, is_reference=True, title=str(token.attrs.get("title", "")))
        return place if target and (is_image or not is_local) else None
    at += 1
    while state.src[at : at + 1] in {" ", "\n"}:
        at += 1
    parsed = state.md.helpers.parseLinkDestination(state.src, at, state.posMax)
    return _LinkTarget(at, parsed.pos, parsed.str, is_image) if parsed.ok and parsed.str else None


def _attribute_list(state: StateInline) -> str:
    """Return kramdown's, Pandoc's and MkDocs' `{:style="…"}` after a link or an image, which styles it; "" if none."""
    rest = state.src[state.pos :]
    text = rest[: rest.find("}") + 1]
    return text if text.startswith("{") and (text[1] in ":.#" or "=" in text) else ""


@functools.lru_cache(maxsize=8)
def _parsed(text: str) -> tuple[list[Token], dict[str, Any]]:
    """Return the blocks of a chapter's text, and its definitions; a footnote, `[^1]: text`, is not one."""
    env: dict[str, Any] = {}
    tokens = _parser().parse(text, env)
    return tokens, {label: to for label, to in env.get("references", {}).items() if not label.startswith("^")}


def references_in(text: str) -> dict[str, Any]:
    """Return the definitions `[label]: target "title"` in a text, as markdown-it keeps them."""
    return dict(_parsed(text)[1]) if "]:" in text else {}


@functools.lru_cache(maxsize=8)
def links_in(text: str) -> tuple[tuple[str, int], ...]:
    """Return the targets of the links and images in a text, each with its line, counted from 1."""
    if "](" not in text and "]:" not in text:
        return ()
    tokens, references = _parsed(text)
    inline = (token for token in tokens if token.type == "inline" and "[" in token.content)
    return tuple(link for token in inline for link in _links_of(token, references))


def _links_of(token: Token, references: Mapping[str, Any]) -> Iterator[tuple[str, int]]:
    line = (token.map or (0, 0))[0] + 1
    children: list[Token] = []
    _parser().inline.parse(token.content, _parser(), {"references": dict(references)}, children)
    for child in children:
        if child.type in {"softbreak", "hardbreak"}:
            line += 1
        if target := str(child.attrs.get("href") or child.attrs.get("src") or ""):
            yield target, line


def linked(text: str, target: Target, references: Mapping[str, Any] = MappingProxyType({})) -> str:
    """Return `text` with the targets of its links and images replaced. No line is added or lost.

    `references` are definitions that are elsewhere: links and images that use them get their targets. An image with a
    width or a height in an attribute list becomes HTML.
    """
    if not any(mark in text for mark in ("](", "]:", "<", *(["["] if references else []))):
        return text
    md = _parser()
    env: dict[str, Any] = {}
    lines = text.split("\n")
    at = [0] * len(lines)
    tokens = md.parse(text, env)
    local = env.get("references", {})
    env = {"references": {**references, **local}, "local": local}
    for token in tokens:
        first = (token.map or (0, 0))[0]
        if token.type == "inline":
            env |= {"watched": token.content, "found": []}
            md.inline.parse(token.content, md, env, [])
            put(lines, at, first, token.content, _edits(token.content, env["found"], target))
        elif token.type == "html_block":
            for number, line in enumerate(token.content.rstrip("\n").split("\n"), start=first):
                if line and (place := lines[number].find(line)) >= 0:
                    lines[number] = lines[number][:place] + in_html(line, target) + lines[number][place + len(line) :]
    _references(lines, local, target)
    return "\n".join(lines)


#: A part of an inline token's content, from a character to another one, and its new text.
Edit = tuple[int, int, str]


def _edits(content: str, targets: Iterable[_LinkTarget], target: Target) -> Iterator[Edit]:
    """Yield the new targets in an inline token's content; a target over several lines stays."""
    for item in targets:
        new = None if "\n" in content[item.start : item.end] else _new(content, item, target)
        if new is not None:
            yield item.start, item.end, new


def put(lines: list[str], at: list[int], first: int, content: str, edits: Iterable[Edit]) -> None:
    """Put new texts into the lines of an inline token. `at` is how far each line has been read; it is updated.

    What replaces a part over several lines goes into the first of them if the last has more text, else into the last.
    """
    places = list(places_of(lines, at, first, content))
    for start, end, new in sorted(edits, key=lambda edit: -edit[0]):
        parts = content[start:end].split("\n")
        starts = itertools.accumulate((len(part) + 1 for part in parts[:-1]), initial=start)
        spots = [spot for spot in (place_of(places, content, offset) for offset in starts) if spot is not None]
        if len(spots) < len(parts):
            continue
        number, column = spots[-1]
        has_more = bool(lines[number][column + len(parts[-1]) :].strip())
        chosen = 0 if has_more else len(parts) - 1
        for row, ((number, column), part) in enumerate(zip(spots, parts, strict=True)):
            text, rest = new if row == chosen else "", lines[number][column + len(part) :]
            lines[number] = lines[number][:column] + text + (rest if row == chosen else rest.lstrip(" "))
            at[number] += len(text) - len(part)


def places_of(lines: list[str], at: list[int], first: int, content: str) -> Iterator[tuple[int, int] | None]:
    """Yield where each line of an inline token's content is: (number of the line, column).

    `first` is the token's first line. `at` is how far each line has been read; it is updated.
    """
    for row, part in enumerate(content.split("\n")):
        number = first + row
        place = lines[number].find(part, at[number]) if number < len(lines) else -1
        if place >= 0:
            at[number] = place + len(part)
        yield (number, place) if place >= 0 else None


def place_of(places: Sequence[tuple[int, int] | None], content: str, offset: int) -> tuple[int, int] | None:
    """Return where a character of an inline token's content is, given the `places_of` its lines."""
    place = places[content.count("\n", 0, offset)]
    return place and (place[0], place[1] + offset - (content.rfind("\n", 0, offset) + 1))


def _new(content: str, item: _LinkTarget, target: Target) -> str | None:
    if item.is_html:
        changed = in_html(item.target, target)
        return changed if changed != item.target else None
    if not item.target:
        return ""
    new = target(item.target, item.is_image)
    if item.is_reference:
        title = f' "{item.title}"' if item.title else ""
        return f"({_in_brackets(new or item.target)}{title})"
    return None if new is None else _in_brackets(new)


def _in_brackets(target: str) -> str:
    return f"<{target}>" if " " in target else target


def _references(lines: list[str], references: dict[str, Any], target: Target) -> None:
    """Put new targets into definitions such as `[label]: target "title"`."""
    for reference in references.values():
        number = reference["map"][0]
        before, mark, behind = lines[number].partition("]:")
        new = target(reference["href"], False)
        if mark and new is not None:
            words = behind.strip().split(" ", 1)
            title = f" {words[1]}" if len(words) > 1 else ""
            lines[number] = f"{before}{mark} {new}{title}"


def in_html(html: str, target: Target) -> str:
    """Return a piece of HTML with the targets of its images and links replaced."""
    tags = _Tags()
    tags.feed(html)
    for tag, raw, value in tags.with_target:
        new = target(value, tag != "a")
        if new is not None:
            quoted = next((q for q in (f'"{value}"', f"'{value}'", f'"{escape(value)}"') if q in raw), None)
            changed = raw.replace(quoted, f'"{new}"', 1) if quoted else raw
            html = html.replace(raw, changed, 1)
    return html


class _Tags(HTMLParser):
    """Finds the tags that have a target: (tag, as it is written, target)."""

    def __init__(self) -> None:
        super().__init__(convert_charrefs=False)
        self.with_target: list[tuple[str, str, str]] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        value = dict(attrs).get(_ATTRIBUTES.get(tag, ""))
        if value:
            self.with_target.append((tag, self.get_starttag_text() or "", unescape(value)))
