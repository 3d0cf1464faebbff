"""MyST's cross-references: what a chapter's labels name, and `{ref}`, `{doc}`, `{numref}`, `[](label)` as plain links.

A reference becomes a link to the file of a chapter and a heading in it, by the id that JupyterLab gives the heading.
The site uses other ids: see `Heading.slug`.
"""

from __future__ import annotations

import functools
import posixpath
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import quote, unquote

from markdown_it import MarkdownIt
from markdown_it.rules_inline import StateInline
from markdown_it.token import Token
from mdit_py_plugins.anchors.index import slugify, unique_slug
from mdit_py_plugins.myst_role import myst_role_plugin

from groundwork.problem import Problem, Severity
from spinbook.chapter.block import Block, BlockKind
from spinbook.chapter.files import is_elsewhere, locate
from spinbook.chapter.links import put, watch

_ROLES = frozenset({"ref", "doc", "numref", "any", "std:ref", "std:doc", "std:numref"})
#: The content of a role: `words <target>`.
_TITLED = re.compile(r"(.*?)\s*<([^<>]+)>$", re.DOTALL)
#: The place of a number that only Sphinx knows.
_NUMBER = re.compile(r"\s*(?:%s|\{number\}|\{name\})\s*")
_LABEL = re.compile(r"[\w:-]+")
#: Characters that a fragment may contain unquoted.
_SAFE = "/?:@!$&'*+,;=-._~"


@dataclass(frozen=True)
class Heading:
    """A heading of a chapter: its words as Markdown, its id in JupyterLab, and its id on the site."""

    words: str
    anchor: str
    slug: str


@dataclass(frozen=True)
class Label:
    """What a label names: a place in a chapter's file, and the words for it. `anchor` is "" at the top."""

    file: Path
    anchor: str
    words: str


def words_of(heading: Block) -> str:
    """Return a heading's words, as Markdown."""
    return _first_words("\n".join(line.text for line in heading.lines))


@functools.lru_cache(maxsize=4096)
def _first_words(markdown: str) -> str:
    tokens = _plain_parser().parse(markdown)
    inline = next((token for token in tokens if token.type == "inline"), None)
    return inline.content.partition(" {#")[0] if inline else ""


def headings(blocks: Iterable[Block]) -> Iterator[Heading]:
    """Yield the headings of a chapter, in order. JupyterLab finds the first of equal ones."""
    seen: set[str] = set()
    for block in _all(blocks):
        if block.kind is BlockKind.HEADING:
            words = words_of(block)
            text = _text(words)
            first = slugify(text) not in seen
            slug = unique_slug(slugify(text), seen)
            yield Heading(words, text.replace(" ", "-") if first else slug, slug)


def labels(blocks: Sequence[Block], file: Path) -> dict[str, Label]:
    """Return a chapter's labels: a label before a heading names it, any other label the section around it."""
    coming = headings(blocks)
    named: dict[str, Label] = {}
    waiting: list[str] = []
    above = Heading("", "", "")
    for block in _all(blocks):
        if block.kind is BlockKind.HEADING:
            above = next(coming)
        elif not any(line.text.strip() for line in block.lines):
            continue
        if block.label and block.kind is BlockKind.DROPPED:
            waiting.append(block.label)
            continue
        here = [*waiting, *([block.label] if block.label else [])]
        words = (block.title if block.label else "") or above.words
        named = {**{_normal(name): Label(file, above.anchor, words) for name in here}, **named}
        waiting = []
    return named


def _all(blocks: Iterable[Block]) -> Iterator[Block]:
    return (inner for top in blocks for inner in top.walk())


def _normal(label: str) -> str:
    return " ".join(label.lower().split())


@functools.cache
def _plain_parser() -> MarkdownIt:
    return MarkdownIt("commonmark")


@functools.lru_cache(maxsize=4096)
def _text(markdown: str) -> str:
    """Return the text of Markdown without its markup."""
    (inline,) = _plain_parser().parseInline(markdown)
    return "".join(" " if "break" in child.type else child.content for child in inline.children or [])


@dataclass(frozen=True)
class _LabelReference:
    """A reference in an inline token's content, from `start` to `end`. `role` is "" for a link."""

    start: int
    end: int
    role: str
    words: str
    target: str


def may_refer(text: str, known: Collection[str]) -> bool:
    """Return whether a text may have references to these labels: a quick test before parsing."""
    return "}`" in text or "[](" in text or ("](" in text and bool(known))


@dataclass(frozen=True)
class References:
    """The references of one chapter. `known` are all labels, its own first, `titles` the chapters' titles by file.

    `sections` are the chapter's own headings by their ids on the site.
    """

    root: Path
    file: Path
    known: Mapping[str, Label]
    titles: Mapping[Path, str]
    sections: Mapping[str, Heading]

    def resolved(self, text: str) -> str:
        """Return `text` with links in place of its references. No line is added or lost."""
        if not may_refer(text, self.known):
            return text
        lines = text.split("\n")
        at = [0] * len(lines)
        for first, content, references in _references(text):
            new = ((item, self._new(item)[0]) for item in references)
            put(lines, at, first, content, ((item.start, item.end, text) for item, text in new if text is not None))
        return "\n".join(lines)

    def problems(self, blocks: Iterable[Block]) -> Iterator[Problem]:
        """Yield a problem for each unknown name, where it is first used."""
        reported: set[str] = set()
        for block in _all(blocks):
            lines = block.new or block.lines
            text = "\n".join(line.text for line in lines)
            if block.children or block.fence or block.kind is BlockKind.DROPPED or not may_refer(text, self.known):
                continue
            for first, content, references in _references(text):
                for item in references:
                    _, unknown = self._new(item)
                    if unknown and unknown not in reported:
                        reported.add(unknown)
                        row = first + content.count("\n", 0, item.start)
                        yield self._problem(item, unknown, lines[min(row, len(lines) - 1)].number)

    def is_label(self, target: str) -> bool:
        """Return whether the target of a link is a label, known or not, rather than a file."""
        folder = self.file.parent.as_posix()
        looks_so = _normal(unquote(target)) in self.known or (bool(self.known) and bool(_LABEL.fullmatch(target)))
        return looks_so and locate(self.root, folder, target) is None

    def has(self, anchor: str) -> bool:
        """Return whether an anchor is a label."""
        return _normal(unquote(anchor)) in self.known

    def _problem(self, item: _LabelReference, unknown: str, line: int) -> Problem:
        if item.role.endswith("doc"):
            problem = f"a reference leads to the document `{unknown}`, and there is no such file."
            fix = "Write its path relative to the chapter's folder, without .md."
        else:
            problem = f"a reference leads to the label `{unknown}`, which no chapter has."
            fix = f"Write `({unknown})=` on a line before the heading that is meant."
        return Problem(self.file, line, problem, fix, Severity.WARNING, group="labels that no chapter has")

    def _new(self, item: _LabelReference) -> tuple[str | None, str]:
        """Return (the replacement of a reference, the unknown name in it); None leaves the reference as it is."""
        if item.role.endswith("doc"):
            return self._document(item.words, item.target)
        name = unquote(item.target.removeprefix("#"))
        label = self.known.get(_normal(name))
        if item.role:
            words = _NUMBER.sub(" ", item.words).strip() if item.role.endswith("numref") else item.words
            return (self._link(label, words), "") if label else (words or name, name)
        if label and (item.target.startswith("#") or self.is_label(item.target)):
            return self._link(label, item.words), ""
        return self._other_link(item)

    def _other_link(self, item: _LabelReference) -> tuple[str | None, str]:
        """Replace a link to a label that no chapter has, or a link without words to a heading or a chapter."""
        heading = self.sections.get(item.target.removeprefix("#")) if item.target.startswith("#") else None
        if heading and not item.words:
            return self._link(Label(self.file, heading.anchor, heading.words), ""), ""
        if self.is_label(item.target) or (not item.words and _LABEL.fullmatch(item.target.removeprefix("#"))):
            name = item.target.removeprefix("#")
            return item.words or name, name
        if item.words or is_elsewhere(item.target):
            return None, ""
        file = locate(self.root, self.file.parent.as_posix(), item.target)
        return (f"[{self.titles[file]}]({item.target})", "") if file in self.titles and file else (None, "")

    def _document(self, words: str, target: str) -> tuple[str, str]:
        file = locate(self.root, self.file.parent.as_posix(), target)
        if file is None:
            return words or target, target
        return self._link(Label(file, "", ""), words), ""

    def _link(self, label: Label, words: str) -> str:
        path = posixpath.relpath(label.file.as_posix(), self.file.parent.as_posix() or ".")
        anchor = f"#{quote(label.anchor, safe=_SAFE)}" if label.anchor else ""
        shown = words or label.words or self.titles.get(label.file, label.file.stem)
        # A link can't hold another one.
        shown = _text(shown).replace("[", r"\[").replace("]", r"\]") if "[" in shown else shown
        return f"[{shown}]({quote(path)}{anchor})"


@functools.cache
def _parser() -> MarkdownIt:
    md = MarkdownIt("commonmark", {"html": True}).enable("table").use(myst_role_plugin)
    md.core.ruler.enableOnly(["normalize", "block"])
    for name, read in (("link", _link), ("myst_role", _role)):
        watch(md, name, read)
    return md


def _role(state: StateInline, start: int, before: int) -> list[_LabelReference]:
    token = next(token for token in state.tokens[before:] if token.type == "myst_role")
    name = str(token.meta["name"])
    content = token.content.strip()
    titled = _TITLED.match(content)
    words, target = (titled[1], titled[2].strip()) if titled else ("", content)
    return [_LabelReference(start, state.pos, name, words, target.lstrip("!~"))] if name in _ROLES else []


def _link(state: StateInline, start: int, before: int) -> list[_LabelReference]:
    """Return a link with its target after its words; that of `[words][name]` is elsewhere."""
    opening = next(token for token in state.tokens[before:] if token.type == "link_open")
    end, pos = state.pos, state.pos
    label_end = state.md.helpers.parseLinkLabel(state, start, False)
    state.pos = pos
    if state.src[label_end + 1 : label_end + 2] != "(" or "title" in opening.attrs:
        return []
    words = state.src[start + 1 : label_end].replace("\n", " ")
    return [_LabelReference(start, end, "", words, unquote(str(opening.attrs.get("href", ""))))]


def _references(text: str) -> Iterator[tuple[int, str, list[_LabelReference]]]:
    """Yield (first line, content, references) for each part of a text that is parsed as a unit, such as a paragraph."""
    md = _parser()
    env: dict[str, Any] = {}
    for token in md.parse(text, env):
        if token.type == "inline":
            yield (token.map or (0, 0))[0], token.content, _in_inline(md, token, env)


def _in_inline(md: MarkdownIt, token: Token, env: dict[str, Any]) -> list[_LabelReference]:
    env |= {"watched": token.content, "found": []}
    md.inline.parse(token.content, md, env, [])
    out: list[_LabelReference] = []
    for item in sorted(env["found"], key=lambda item: (item.start, -item.end)):
        if not out or item.start >= out[-1].end:
            out.append(item)
    return out
