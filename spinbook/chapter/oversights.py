"""What a book's own tool would replace or refuse, and a chapter would show or lose without a word."""

from __future__ import annotations

import contextlib
import re
import unicodedata
from collections.abc import Iterable, Iterator
from pathlib import Path
from urllib.parse import unquote

from pygments.lexers import find_lexer_class_by_name
from pygments.util import ClassNotFound

from groundwork.problem import Problem, Severity
from groundwork.words import did_you_mean, similar
from spinbook.chapter.attributes import BLOCKS, COMPONENTS
from spinbook.chapter.block import Block, BlockKind
from spinbook.chapter.fence import PYTHON, SHELL
from spinbook.chapter.labels import headings

#: What opens a block, with its kind or its language, and those that a misspelt one may mean; and MDX's tags.
_OPENING = re.compile(r"\s*(?::{3,}|`{3,}|~{3,}|!!!|\?\?\?\+?) *\{?([a-z][a-z-]+)")
_KNOWN = (*BLOCKS, *PYTHON, *SHELL)
_TAG = re.compile(r"\s*<([A-Z][A-Za-z]+)\b")
#: `{{ name }}` and `{% tag %}` of Jinja and Liquid, and `@fig-name` of Quarto, but no braces of JSX or of a formula.
#: Code and comments match as well, so that they are skipped.
_MACRO = re.compile(
    r"`+[^`]*`+|<!--[^>]{0,400}|(?<![\w=^$\\{}])(\{\{[^{}\\]{1,200}\}\}|\{%-?[^{}%]{1,200}%\}|(?<!@)@(?:sec|fig|tbl|eq|lst)-[\w-]+)"
)
#: How authors name a place themselves: in HTML, in an attribute list, as a label of MyST's, as a directive's option,
#: and in a heading within a quotation, a list or HTML.
_NAMED = re.compile(
    r"""\b(?:id|name)\s*=\s*\{?["']?([^"'\s<>{}]+)|\{[^{}\n]*#([^\s{}]+)|^\s*\(([^()\n]+)\)=|^\s*:(?:name|label):\s*(\S+)"""
    r"""|\$\$\s*\(([^()\n]+)\)|^\s*(?:[>*+-]\s*)+#{1,6}\s+(.+)|<h[1-6][^<>]*>([^<>]+)"""
)
#: What browsers and book tools understand or number themselves: text to look for, footnotes, tabs, `#id1`.
_GENERATED = re.compile(r":~:|fn(?:ref)?[-:]|_*tabbed_|_*(?:id|section-)?\d+$")


def misspelt(blocks: Iterable[Block], file: Path, text: str) -> Iterator[Problem]:
    """Yield kinds of blocks, languages and tags that look like misspellings; any other may be a book tool's own."""
    for block in blocks:
        opening = _OPENING.match(block.lines[0].text) if block.lines else None
        if opening and opening[1] not in _KNOWN and (near := similar(opening[1], _KNOWN, 0.8)):
            with contextlib.suppress(ClassNotFound):
                find_lexer_class_by_name(opening[1])  # a language that looks like another one
                continue
            problem = f"`{opening[1]}` is not a known kind of block or language."
            yield Problem(file, block.line, problem, f"Did you mean `{near}`?", Severity.WARNING)
        for line in () if block.fence or (block.children and block.kind is not BlockKind.GROUP) else block.lines[:1]:
            tag = _TAG.match(line.text)
            if tag and tag[1] not in COMPONENTS and (near := similar(tag[1], COMPONENTS, 0.8)):
                if re.search(rf"(?m)^\s*(?:import|export)\b[^'\"]{{0,400}}\b{tag[1]}\b", text):
                    continue  # a component of the book's own
                problem = f"`<{tag[1]}>` is not a known component, so only what it holds is shown."
                yield Problem(file, line.number, problem, f"Did you mean `<{near}>`?", Severity.WARNING)


def macros(blocks: Iterable[Block], file: Path) -> Iterator[Problem]:
    """Yield the macros that are left in the text."""
    for block in blocks:
        if block.children or block.kind not in (BlockKind.TEXT, BlockKind.HEADING):
            continue
        for line in block.new or block.lines:
            for macro in filter(None, (match[1] for match in _MACRO.finditer(line.text))):
                problem = f"`{macro}` is a macro of a book's tool, and is shown as it is."
                fix = "Write what it stands for, or put it between backticks if it is meant."
                yield Problem(file, line.number, problem, fix, Severity.WARNING, group="macros")


class Anchors:
    """The places of a chapter that links may lead to: its headings, and what its author has named."""

    def __init__(self, blocks: Iterable[Block]) -> None:
        blocks = list(blocks)
        self._slugs = [heading.slug for heading in headings(blocks)]
        lines = (line.text for top in blocks for block in top.walk() for line in (block.new or block.lines))
        named = (next(filter(None, match.groups())) for line in lines for match in _NAMED.finditer(line))
        known = {_comparable(name) for name in (*self._slugs, *named, "top")}
        # Pandoc leaves out leading digits, MkDocs and Sphinx letters other than English ones.
        self._known = known | {name.lstrip("0123456789") for name in known}
        self._known |= {name.encode("ascii", "ignore").decode() for name in known}

    def problem(self, anchor: str, target: str, place: Path, file: Path, line: int) -> Problem | None:
        """Return what is wrong with a link to `anchor` at `place`; None if it is there or can't be known."""
        name = _comparable(anchor)
        if not name or name in self._known or _GENERATED.match(anchor):
            return None
        problem = f"a link leads to `{target}`, and {place} has no such heading."
        otherwise = "Write the heading's words in lower case, with hyphens."
        fix = did_you_mean(anchor, self._slugs, otherwise, "`#{}`")
        return Problem(file, line, problem, fix, Severity.WARNING, group="headings that no chapter has")


def _comparable(anchor: str) -> str:
    """Return an anchor's letters and digits, as each book tool makes other anchors of a heading."""
    letters = unicodedata.normalize("NFKD", unquote(anchor).casefold())
    return "".join(filter(str.isalnum, letters))
