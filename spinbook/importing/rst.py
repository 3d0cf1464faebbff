"""reStructuredText as MyST Markdown: docutils parses it, with the directives and roles that Sphinx adds."""

from __future__ import annotations

import contextlib
import itertools
import re
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from docutils import nodes
from docutils.core import publish_doctree
from docutils.parsers.rst import Directive, directives, roles

_DIRECTIVE = re.compile(r"^\s*(?:\|[^|]+\|\s+)?\.\.\s+(?:\|[^|]+\|\s+)?([\w.:+-]+)::", re.MULTILINE)
_ROLE = re.compile(r":([\w.:+-]+):`")
#: Directives that have nothing for the reader of one chapter.
_UNSEEN = frozenset(
    {"toctree", "contents", "index", "highlight", "tabularcolumns", "meta", "default-role", "only", "redirect-from"}
)
_CODE = frozenset({"code-block", "sourcecode", "code"})
#: Directives that hold what is typed in a terminal or in Python, and the language if they do not name it.
_TYPED = {"prompt": "bash", "terminal": "bash", "ipython": "python", "jupyter-execute": "python"}
#: Sphinx's directives whose first line is a title, and what they are in MyST.
_TITLED = {**dict.fromkeys(("tab", "group-tab", "code-tab", "tab-item"), "tab-item"), "dropdown": "dropdown"}
#: Roles that MyST has, too; chapters turn them into links.
_REFERENCES = frozenset({"ref", "doc", "numref"})
_BOLD = frozenset({"guilabel", "menuselection", "kbd"})
#: What Markdown would read as a mark in plain text.
_SPECIAL = re.compile(r"[*`\[\]<\\]|(?<!\w)_|_(?!\w)")
#: Takes every option, as text. docutils takes an empty one for none.
_ANY_OPTION = defaultdict(lambda: directives.unchanged, name=directives.unchanged)
_ADMONITIONS = ("note", "tip", "hint", "important", "warning", "caution", "danger", "error", "attention")


class _Anything(Directive):  # type: ignore[misc]  # docutils has no types
    """A directive that docutils does not know: its name, title and content are kept."""

    optional_arguments = 1
    final_argument_whitespace = True
    has_content = True
    option_spec = _ANY_OPTION

    def run(self) -> list[nodes.Node]:
        """Return a container with what is in it; code stays as it is."""
        argument = " ".join(self.arguments)
        if self.name in _UNSEEN:
            return []
        if self.name in _CODE or self.name in {"literalinclude", "mermaid", "math", "graphviz"}:
            text = "\n".join(self.content)
            return [nodes.literal_block(text, text, language=argument, kind=self.name, options=self.options)]
        if self.name in _TYPED:
            text, language = "\n".join(self.content), (argument or _TYPED[self.name]).split(" ")[0]
            return [nodes.literal_block(text, text, language=language)]
        holder = nodes.container("", kind=self.name, title=argument)
        self.state.nested_parse(self.content, self.content_offset, holder)
        return [holder]


def _any_role(name: str, raw: str, text: str, *_: Any, **__: Any) -> tuple[list[nodes.Node], list[nodes.Node]]:
    return [nodes.inline(raw, text, kind=name)], []


def markdown_of(text: str, file: Path) -> str:
    """Return a reStructuredText file as Markdown. What docutils can't read stays as text."""
    settings = {
        "report_level": 5,
        "halt_level": 5,
        "doctitle_xform": False,
        "smart_quotes": False,
        "raw_enabled": False,
    }
    with _known(set(_DIRECTIVE.findall(text)), set(_ROLE.findall(text))):
        document = publish_doctree(text, source_path=str(file), settings_overrides=settings)
    lines = _Writer().blocks(document.children, 0)
    return "\n".join(lines).strip("\n") + "\n"


@contextlib.contextmanager
def _known(names: set[str], role_names: set[str]) -> Iterator[None]:
    """Let docutils read these directives and roles while the block runs, as well as it can."""
    before = dict(directives._directives), dict(roles._roles)
    # Without what Sphinx registers, if this process has made a site.
    directives._directives, roles._roles = {}, {}
    standard = directives._directive_registry
    for name in names:
        if name in _CODE | _UNSEEN or name not in standard:
            directives.register_directive(name, _Anything)
    for name in role_names - {"math", "sub", "sup", "code", "raw"}:
        roles.register_local_role(name, _any_role)
    try:
        yield
    finally:
        directives._directives, roles._roles = before


class _Writer:
    """Writes docutils' nodes as lines of Markdown. A method `_NAME` writes the nodes of that class."""

    def blocks(self, children: Iterable[nodes.Node], level: int) -> list[str]:
        lines: list[str] = []
        for child in children:
            write = getattr(self, f"_{type(child).__name__}", None)
            new = write(child, level) if write else self._other(child, level)
            while new and not new[-1]:
                new.pop()
            lines += [*new, ""] if new else []
        return lines

    def _other(self, node: nodes.Node, level: int) -> list[str]:
        """Write a node that Markdown lacks: what is in it, or its text."""
        if isinstance(node, nodes.Invisible | nodes.system_message):
            return []
        if isinstance(node, nodes.TextElement | nodes.Text):
            return self.inline([node]).split("\n")
        return self.blocks(node.children, level)

    def _section(self, node: nodes.section, level: int) -> list[str]:
        # The heading's own name is none of the author's labels, unless one is spelt like it.
        names = [name for name in node["names"] if node.document.nametypes.get(name)]
        return [*(f"({name.replace(' ', '-')})=" for name in names), *self.blocks(node.children, level + 1)]

    def _title(self, node: nodes.title, level: int) -> list[str]:
        return [f"{'#' * max(level, 1)} {self.inline(node.children)}"]

    def _paragraph(self, node: nodes.paragraph, level: int) -> list[str]:
        return self.inline(node.children).split("\n")

    def _literal_block(self, node: nodes.literal_block, level: int) -> list[str]:
        kind, options = node.get("kind", "code"), node.get("options", {})
        classes = [name for name in node["classes"] if name != "code"]
        language = node.get("language") or (classes[0] if classes else "")
        code = node.astext().split("\n")
        if kind in {"literalinclude", "mermaid", "math"}:
            option_lines = [f":{key}: {value or ''}".rstrip() for key, value in options.items()]
            return [f"```{{{kind}}} {language}".rstrip(), *option_lines, *(code if any(code) else []), "```"]
        file = str(options.get("caption") or options.get("name") or "")
        title = f' title="{file}"' if re.fullmatch(r"[\w./~-]+\.\w+", file) else ""
        mark = "````" if any(line.lstrip().startswith("```") for line in code) else "```"
        return [f"{mark}{language}{title}", *code, mark]

    _doctest_block = _literal_block

    def _bullet_list(self, node: nodes.bullet_list, level: int) -> list[str]:
        return self._items(node, ("- " for _ in node.children), level)

    def _enumerated_list(self, node: nodes.enumerated_list, level: int) -> list[str]:
        first = int(node.get("start", 1))
        return self._items(node, (f"{number}. " for number in itertools.count(first)), level)

    def _items(self, node: nodes.Element, markers: Iterator[str], level: int) -> list[str]:
        lines: list[str] = []
        for item, marker in zip(node.children, markers, strict=False):
            inner = self.blocks(item.children, level)
            lines += _indented(inner, marker, " " * len(marker))
        return lines

    def _definition_list_item(self, node: nodes.definition_list_item, level: int) -> list[str]:
        term = self.inline(node[0].children)
        return [f"**{term}**", "", *self.blocks(node[-1].children, level)]

    def _field(self, node: nodes.field, level: int) -> list[str]:
        return _indented(self.blocks(node[1].children, level), f"**{node[0].astext()}**: ", "")

    def _block_quote(self, node: nodes.block_quote, level: int) -> list[str]:
        return [f"> {line}".rstrip() for line in self.blocks(node.children, level)[:-1]]

    def _line_block(self, node: nodes.line_block, level: int) -> list[str]:
        return [f"{self.inline(line.children)}  " for line in node.findall(nodes.line)]

    def _admonition(self, node: nodes.Element, level: int) -> list[str]:
        name, children = type(node).__name__, node.children
        title = ""
        if name == "admonition" or isinstance(node, nodes.topic | nodes.sidebar):
            name, title, children = "admonition", f" {node[0].astext()}", node.children[1:]
        return self._directive(name + "}" + title, children, level)

    _topic = _sidebar = _admonition

    def _container(self, node: nodes.container, level: int) -> list[str]:
        kind, title = node.get("kind", ""), node.get("title", "")
        if kind in _TITLED:
            return self._directive(f"{_TITLED[kind]}}} {title}", node.children, level)
        if kind in {"tabs", "tab-set"}:
            return self._directive("tab-set}", node.children, level)
        if kind in {"seealso", "versionadded", "versionchanged", "deprecated", "todo"}:
            words = [nodes.paragraph(title, title)] if title else []
            return self._directive("note}", [*words, *node.children], level)
        return self.blocks(node.children, level)

    def _directive(self, opening: str, children: Sequence[nodes.Node], level: int) -> list[str]:
        inside = self.blocks(children, level)
        colons = ":" * max([3, *(len(line) - len(line.lstrip(":")) + 1 for line in inside if line.startswith(":::"))])
        return [f"{colons}{{{opening}", *inside[:-1], colons]

    def _image(self, node: nodes.image, level: int) -> list[str]:
        return [self.inline([node])]

    def _figure(self, node: nodes.figure, level: int) -> list[str]:
        return self.blocks(node.children, level)

    def _caption(self, node: nodes.caption, level: int) -> list[str]:
        return [f"*{self.inline(node.children)}*"]

    def _math_block(self, node: nodes.math_block, level: int) -> list[str]:
        return ["$$", *node.astext().split("\n"), "$$"]

    def _transition(self, node: nodes.transition, level: int) -> list[str]:
        return ["---"]

    def _target(self, node: nodes.target, level: int) -> list[str]:
        return [f"({name.replace(' ', '-')})=" for name in node["names"]] if not node.get("refuri") else []

    def _table(self, node: nodes.table, level: int) -> list[str]:
        rows = [[self._cell(entry) for entry in row.findall(nodes.entry)] for row in node.findall(nodes.row)]
        width = max(map(len, rows), default=0)
        lines = [f"| {' | '.join([*row, *[''] * (width - len(row))])} |" for row in rows]
        title = [line for item in node.findall(nodes.title) for line in (f"**{self.inline(item.children)}**", "")]
        return [*title, *lines[:1], f"|{' --- |' * width}", *lines[1:]] if lines else []

    def _cell(self, entry: nodes.entry) -> str:
        return " ".join(line for line in self.blocks(entry.children, 0) if line).replace("|", "\\|")

    def inline(self, children: Iterable[nodes.Node]) -> str:
        """Return nodes within a line as Markdown."""
        return "".join(self._span(child) for child in children)

    def _span(self, node: nodes.Node) -> str:
        if isinstance(node, nodes.Text):
            return _SPECIAL.sub(r"\\\g<0>", str(node))
        if isinstance(node, nodes.literal):
            return f"`{node.astext()}`"
        if isinstance(node, nodes.math):
            return f"${node.astext()}$"
        if isinstance(node, nodes.image):
            alt, width = node.get("alt", ""), node.get("width", "")
            size = f'{{width="{width}"}}' if width else ""
            return f"![{alt if alt != node['uri'] else ''}]({node['uri']}){size}"
        if isinstance(node, nodes.inline) and node.get("kind"):
            return self._role(node["kind"], node.astext())
        inner = self.inline(node.children)
        if isinstance(node, nodes.reference) and (node.get("refuri") or node.get("refid")):
            return f"[{inner}]({node.get('refuri') or '#' + node['refid']})"
        mark = {nodes.emphasis: "*", nodes.strong: "**", nodes.title_reference: "*"}.get(type(node), "")
        return f"{mark}{inner}{mark}"

    def _role(self, kind: str, text: str) -> str:
        kind = kind.rpartition(":")[2]
        if kind in _REFERENCES:
            return f"{{{kind}}}`{text}`"
        return f"**{text}**" if kind in _BOLD else f"`{re.sub(r'^[~!]', '', text.partition(' <')[0])}`"


for _name in _ADMONITIONS:
    setattr(_Writer, f"_{_name}", _Writer._admonition)


def _indented(lines: Sequence[str], first: str, rest: str) -> list[str]:
    return [f"{rest if number else first}{line}".rstrip() for number, line in enumerate(lines)] or [first.rstrip()]
