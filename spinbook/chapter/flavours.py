"""The Markdown that books are written in: CommonMark, and the blocks that other book tools add to it.

Each addition is a block rule of markdown-it, so fences and code in a line are never mistaken for one:

- containers `:::note[Title]`, `::: tip`, `:::{warning}` (Docusaurus, VitePress, MyST, Quarto): mdit-py-plugins
- `!!! note "Title"`, `??? tip` (MkDocs): mdit-py-plugins, tabs `=== "Title"` (pymdownx.tabbed), and `/// note | Title`
- tags of MDX on lines of their own, `<Tabs>`, `<TabItem label="Python">`, and `import …`, `export …`, `{/* … */}`
- `{% tab %}`, `{% hint %}` (Jekyll, GitBook), Hugo's `{{< tab >}}`, kramdown's `{: .note }`
- docsify's `!> text`, MyST's `(label)=` and `+++`
- `--8<-- "file.py"` (pymdownx.snippets)
"""

from __future__ import annotations

import functools
import re
from collections.abc import Callable

from markdown_it import MarkdownIt
from markdown_it.ruler import RuleOptionsType
from markdown_it.rules_block import StateBlock
from mdit_py_plugins.admon import admon_plugin
from mdit_py_plugins.container import container_plugin

from spinbook.chapter import attributes

Rule = Callable[[StateBlock, int, int, bool], bool]

#: What such a line may end: a paragraph, a quotation, a list.
_ALT: RuleOptionsType = {"alt": ["paragraph", "reference", "blockquote", "list"]}
_FENCE = ("```", "~~~")
#: Lines that only book tools understand: the kind of token, and how such a line is written.
_LINES = (
    ("liquid", re.compile(r"\{%-?\s*(?P<name>\w+)\s*(?P<info>.*?)\s*-?%\}$")),
    ("liquid", re.compile(r"\{\{[<%]\s*(?P<name>/?\s*\w+)\s*(?P<info>.*?)\s*/?\s*[%>]\}\}$")),
    ("kramdown", re.compile(r"\{:\s*(?P<info>.*?)\s*\}$")),
    ("snippet", re.compile(r"-+8<-+\s+[\"'](?P<info>.+?)[\"']$")),
    ("callout", re.compile(r"(?P<name>[!?])> (?P<info>.*)")),
    ("label", re.compile(r"\((?P<name>[\w:./-]+)\)=$")),
    ("dropped", re.compile(r"\{/\*")),
    ("dropped", re.compile(r"\+\+\+(?:\s*\{.*\})?$")),
    ("dropped", re.compile(r"""import\s+(?:[\w*{][\w\s{},*]*\s+from\s+)?["'][^"']+["'];?$""")),
    ("dropped", re.compile(r"export\s+(?:const|default|function|let)\b")),
)
#: What may end a tag, or hide its end.
_IN_TAG = re.compile(r"[\"'`{}>]")
_TAG = re.compile(r"<(/?)([A-Z][\w.]*|details|summary)\b")


@functools.cache
def parser() -> MarkdownIt:
    """Return the parser of blocks. It does not parse text within a line: `inline` tokens have no children."""
    md = MarkdownIt("commonmark").enable("table")
    md.core.ruler.enableOnly(["normalize", "block"])
    md.use(admon_plugin)
    md.use(container_plugin, "any", validate=lambda params, *_: bool(params.strip()))
    md.use(container_plugin, "slash", marker="/", validate=lambda params, *_: bool(params.strip()))
    md.block.ruler.before("container_any", "spinbook_line", _line, _ALT)
    md.block.ruler.before("container_any", "spinbook_tab", _tab, _ALT)
    md.block.ruler.before("html_block", "spinbook_tag", _tag, _ALT)
    md.block.ruler.before("html_block", "spinbook_jsx", _jsx, _ALT)
    md.block.ruler.at("html_block", _html_before_fence(md), _ALT)
    return md


def _text(state: StateBlock, line: int) -> str:
    return state.src[state.bMarks[line] + state.tShift[line] : state.eMarks[line]].strip()


def _push(
    state: StateBlock, kind: str, start: int, end: int, name: str = "", info: str = "", content: str = ""
) -> None:
    token = state.push(kind, "", 0)
    token.map = [start, end]
    token.tag, token.info, token.content = name, info, content
    state.line = end


def _line(state: StateBlock, start: int, end: int, silent: bool) -> bool:
    """Parse a line that only book tools understand."""
    text = _text(state, start)
    if not text or state.is_code_block(start):
        return False
    kind, name, info = _parse(text)
    if not kind:
        return False
    # Prose may begin with such words, so they count only on a paragraph's first line.
    if silent:
        return kind != "dropped"
    stop = start + 1
    if kind == "dropped":
        while stop < end and text[0] in "{e" and not _complete(text) and _text(state, stop):
            text += _text(state, stop)
            stop += 1
    _push(state, kind, start, stop, name, info)
    return True


def _parse(text: str) -> tuple[str, str, str]:
    """Return (kind, name, rest) of a line for book tools; ("", "", "") for any other."""
    for kind, pattern in _LINES:
        if match := pattern.match(text):
            parts = match.groupdict()
            # Hugo closes with `/hint` what Liquid closes with `endhint`.
            name = re.sub(r"/\s*", "end", parts.get("name", ""))
            return kind, name if kind == "liquid" else parts.get("name", ""), parts.get("info", "")
    return "", "", ""


def _complete(text: str) -> bool:
    if text.startswith("{/*"):
        return "*/}" in text
    return all(text.count(a) <= text.count(b) for a, b in ("{}", "()", "[]"))


def _tab(state: StateBlock, start: int, end: int, silent: bool) -> bool:
    """Parse `=== "Title"` and the lines below it that are indented by four."""
    text = _text(state, start)
    if not text.startswith("=== ") or state.is_code_block(start):
        return False
    if silent:
        return True
    indent = state.sCount[start] + 4
    stop = start + 1
    while stop < end and (state.isEmpty(stop) or state.sCount[stop] >= indent):
        stop += 1
    while stop > start + 1 and state.isEmpty(stop - 1):
        stop -= 1
    _push(state, "tab", start, stop, info=text[4:].strip(" !+").strip("\"'"))
    return True


def _tag(state: StateBlock, start: int, end: int, silent: bool) -> bool:
    """Parse an opening or closing tag of MDX, or of `<details>`, over one or more lines."""
    if state.src[state.bMarks[start] + state.tShift[start] : state.bMarks[start] + state.tShift[start] + 1] != "<":
        return False
    text = _text(state, start)
    match = _TAG.match(text)
    if match is None or state.is_code_block(start):
        return False
    stop = start + 1
    while (close := _tag_end(text)) < 0 and stop < min(end, start + 200):
        text += "\n" + _text(state, stop)
        stop += 1
    rest = text[close:].strip()
    is_summary = match[2] == "details" and rest.startswith("<summary") and rest.endswith("</summary>")
    if close < 0 or (rest and not is_summary and not _same_line(text, match[2])):
        return False
    if silent:
        return True
    opening = text[:close].rstrip(">")
    closed = opening.endswith("/") or (rest and not is_summary)
    kind = "tag_close" if match[1] else "tag_self" if closed else "tag_open"
    _push(state, kind, start, stop, match[2], opening[match.end() :].strip(" /\n"), text[close:])
    return True


def _jsx(state: StateBlock, start: int, end: int, silent: bool) -> bool:
    """Parse an HTML tag with properties as in MDX: `<img src={require('./a.png').default} style={{…}} />`."""
    text = _text(state, start)
    if not re.match(r"<[a-z]", text) or state.is_code_block(start):
        return False
    stop = start + 1
    while (close := _tag_end(text)) < 0 and stop < min(end, start + 20):
        text += " " + _text(state, stop)
        stop += 1
    if close < 0 or "={" not in text[:close]:
        return False
    if not silent:
        _push(state, "jsx", start, stop, content=attributes.as_html(text[:close]) + text[close:])
    return True


def _same_line(text: str, name: str) -> bool:
    return text.endswith(f"</{name}>") and text.count(f"<{name}") == 1


def _tag_end(text: str) -> int:
    """Return the index after a tag's `>`, outside braces and quotation marks; -1 if it does not end."""
    depth, quote = 0, ""
    for match in _IN_TAG.finditer(text):
        index, letter = match.start(), match[0]
        if quote:
            quote = "" if letter == quote else quote
        elif letter in "\"'`":
            quote = letter
        elif letter in "{}":
            depth += 1 if letter == "{" else -1
        elif letter == ">" and depth <= 0:
            return index + 1
    return -1


def _html_before_fence(md: MarkdownIt) -> Rule:
    """Return CommonMark's rule for HTML blocks, changed so that a fence ends the block, as in other tools."""
    html_block = next(rule.fn for rule in md.block.ruler.__rules__ if rule.name == "html_block")

    def cut(state: StateBlock, start: int, end: int, silent: bool) -> bool:
        if not html_block(state, start, end, silent):
            return False
        if silent:
            return True
        token = state.tokens[-1]
        if token.content.lstrip().lower().startswith(("<pre", "<script", "<style", "<!--", "<textarea")):
            return True
        for line in range(start + 1, state.line):
            if _text(state, line).startswith(_FENCE):
                token.map = [start, line]
                token.content = state.getLines(start, line, state.blkIndent, True)
                state.line = line
                break
        return True

    return cut
