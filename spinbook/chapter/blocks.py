"""A chapter as a tree of blocks: text, fences and containers of blocks, whatever book tool it was written for.

Each level of the tree is parsed on its own, without its container's indentation; lines keep their numbers.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import PurePosixPath

from markdown_it.token import Token

from spinbook.chapter import attributes
from spinbook.chapter.block import (
    Block,
    BlockKind,
    Directive,
    SourceLine,
    as_fence,
    closes,
    dedented,
    fence_block,
    merged_callouts,
    offset_of,
    paired,
    quarto_title,
    unquoted,
)
from spinbook.chapter.components import unindented
from spinbook.chapter.fence import Fence, directive, in_pieces, make_fence
from spinbook.chapter.flavours import parser

#: Reads a file that a chapter includes: its text, or None if there is no such file.
Include = Callable[[str], str | None]
_DEEPEST = 12
#: Files whose text becomes part of the chapter when they are included. Any other is shown as a fence.
_CHAPTERS = (".md", ".mdx", ".qmd", ".markdown")
_TEXTS = (*_CHAPTERS, ".txt", ".html", ".rst", "")

#: Containers of plain Markdown. They stay as they are unless a block inside is not plain Markdown.
_CONTAINERS = frozenset({"container_any_open", "container_slash_open"})
_HOLDERS = frozenset({"blockquote_open", "bullet_list_open", "ordered_list_open"})
_MARKDOWN = _HOLDERS | {"heading_open", "paragraph_open"}


@dataclass
class _Reader:
    include: Include
    depth: int = 0

    def blocks(self, lines: Sequence[SourceLine]) -> tuple[Block, ...]:
        if self.depth > _DEEPEST:
            return (Block(BlockKind.TEXT, tuple(lines)),)
        tokens = parser().parse("\n".join(line.text for line in lines))
        blocks: list[Block] = []
        at = 0
        for index, token in enumerate(tokens):
            if token.level or token.map is None or token.nesting < 0 or token.map[0] < at:
                continue
            start, end = token.map
            if start > at:
                blocks.append(Block(BlockKind.TEXT, tuple(lines[at:start])))
            if token.type in _CONTAINERS and end < len(lines) and set(lines[end].text.strip()) == {token.markup[0]}:
                end += 1
            at = min(max(end, start + 1), len(lines))
            if token.type in _HOLDERS and not any(map(self._is_block, _inside(tokens, index))):
                blocks.append(Block(BlockKind.TEXT, tuple(lines[start:at])))
            else:
                blocks.extend(self._block(token, tuple(lines[start:at])))
        if at < len(lines):
            blocks.append(Block(BlockKind.TEXT, tuple(lines[at:])))
        return paired(merged_callouts(blocks))

    def inside(self, lines: Sequence[SourceLine]) -> tuple[Block, ...]:
        return _Reader(self.include, self.depth + 1).blocks(lines)

    def _block(self, token: Token, lines: tuple[SourceLine, ...]) -> list[Block]:
        read = getattr(self, f"_{token.type}", None)
        return read(token, lines) if read else [Block(BlockKind.TEXT, lines)]

    def _is_block(self, token: Token) -> bool:
        """Return whether it is a fence, an exercise or a book tool's block, so that its container must be read, too."""
        if token.type in {"html_block", "inline"}:
            return bool(attributes.exercise(token.content)) or attributes.has_jsx(token.content)
        return token.type not in _MARKDOWN and hasattr(self, f"_{token.type}")

    def _heading_open(self, token: Token, lines: tuple[SourceLine, ...]) -> list[Block]:
        return [Block(BlockKind.HEADING, lines)]

    def _paragraph_open(self, token: Token, lines: tuple[SourceLine, ...]) -> list[Block]:
        if not attributes.has_jsx("\n".join(line.text for line in lines)):
            return [Block(BlockKind.TEXT, lines)]
        new = tuple(replace(line, text=attributes.without_jsx(line.text)) for line in lines)
        return [Block(BlockKind.TEXT, lines, new=new)]

    def _html_block(self, token: Token, lines: tuple[SourceLine, ...]) -> list[Block]:
        name = attributes.exercise(token.content)
        if not name:
            return self._paragraph_open(token, lines)
        rest = [Block(BlockKind.TEXT, lines[1:])] if len(lines) > 1 else []
        return [Block(BlockKind.EXERCISE, lines[:1], title=name), *rest]

    def _fence(self, token: Token, lines: tuple[SourceLine, ...]) -> list[Block]:
        closed = closes(token.markup, lines)
        name, argument = directive(token.info)
        body = [SourceLine(text, lines[0].number + 1 + i) for i, text in enumerate(token.content.split("\n")[:-1])]
        if name:
            closed = closed or len(lines) == 1
            return self._directive(name, argument, lines, body, closed)
        fence = self._included(make_fence(token.info, token.content, lines[0].number))
        if len(pieces := in_pieces(fence)) > 1:
            return [fence_block(piece, lines) for piece in pieces]
        expanded = fence.code != token.content and "".join(f"{line.text}\n" for line in body) != fence.code
        new = as_fence(fence, lines) if expanded and not fence.skipped else None
        return [Block(BlockKind.FENCE, lines, fence=fence, closed=closed, new=new)]

    def _included(self, fence: Fence) -> Fence:
        if "8<--" not in fence.code:
            return fence
        out: list[str] = []
        for text in fence.code.split("\n"):
            name = attributes.snippet(text)
            content = self.include(name) if name else None
            out += [text] if content is None else content.rstrip("\n").split("\n")
        return replace(fence, code="\n".join(out))

    def _directive(
        self, name: str, argument: str, lines: tuple[SourceLine, ...], body: list[SourceLine], closed: bool
    ) -> list[Block]:
        """Return the blocks of a MyST directive; the first one gets the label from its options."""
        options, skipped = attributes.options([line.text for line in body])
        while skipped < len(body) and not body[skipped].text.strip():
            skipped += 1
        directive = Directive(name, argument, options, lines, body[skipped:], skipped, closed)
        blocks = _DIRECTIVES.get(name, _Reader._holding)(self, directive)
        label = options.get("name") or options.get("label") or ""
        return [replace(blocks[0], label=label), *blocks[1:]] if label and blocks else blocks

    def _code(self, directive: Directive) -> list[Block]:
        info = f"{directive.argument} " + " ".join(f'{key}="{value}"' for key, value in directive.options.items())
        fence = make_fence(f"{{code-cell}} {info}", directive.code, directive.lines[0].number)
        fence = self._included(replace(fence, skipped=directive.skipped))
        return [fence_block(fence, directive.lines, closed=directive.closed)]

    def _literal(self, directive: Directive) -> list[Block]:
        file = directive.argument
        text = self.include(file)
        language = directive.options.get("language", "python" if file.endswith(".py") else "text")
        piece = f'--8<-- "{file}"' if text is None else attributes.part_of_file(text, directive.options)
        title = f' title="{file.rsplit("/", 1)[-1]}"' if file.endswith(".py") and piece == text else ""
        fence = make_fence(language + title, piece.rstrip("\n") + "\n", directive.lines[0].number)
        return [fence_block(fence, directive.lines)]

    def _prompt(self, directive: Directive) -> list[Block]:
        """Return the fence of sphinx-prompt's `{prompt} bash $`, whose lines stand for what follows the prompt."""
        fence = make_fence(directive.argument.split(" ")[0], directive.code, directive.lines[0].number)
        return [fence_block(replace(fence, skipped=directive.skipped), directive.lines)]

    def _list_table(self, directive: Directive) -> list[Block]:
        rows: list[list[str]] = []
        for line in directive.body:
            item = re.match(r"\s*(?P<row>[*-] +)?(?P<cell>[*-])( +|$)(?P<text>.*)", line.text)
            if item and (item["row"] or not rows or not line.text[:1].isspace()):
                rows.append([item["text"]])
            elif item:
                rows[-1].append(item["text"])
            elif rows and line.text.strip():
                rows[-1][-1] += f" {line.text.strip()}"
        if not rows:
            return self._holding(directive)
        table = [rows[0], ["---"] * len(rows[0]), *rows[1:]]
        title = [f"**{directive.argument}**", ""] if directive.argument else []
        new = _at(directive.lines, *title, *(f"| {' | '.join(row)} |" for row in table), "")
        return [Block(BlockKind.TEXT, directive.lines, title=directive.argument, new=new)]

    def _image(self, directive: Directive) -> list[Block]:
        image = attributes.image(directive.argument, directive.options)
        new = (*_at(directive.lines, image, ""), *directive.body)
        caption = next((line.text.strip() for line in directive.body if line.text.strip()), "")
        return [Block(BlockKind.TEXT, directive.lines, title=caption, new=new)]

    def _mermaid(self, directive: Directive) -> list[Block]:
        fence, new = make_fence("mermaid", directive.code, 1), directive.between("```mermaid", "```")
        return [Block(BlockKind.FENCE, directive.lines, fence=fence, closed=directive.closed, new=new)]

    def _math(self, directive: Directive) -> list[Block]:
        return [Block(BlockKind.TEXT, directive.lines, new=directive.between("$$", "$$"))]

    def _holding(self, directive: Directive) -> list[Block]:
        """Return an admonition, a tab or another container; an unknown directive becomes a fence."""
        kind, style, title = attributes.container(directive.name, directive.argument)
        if kind is None:
            fence = make_fence(directive.name, directive.code, directive.lines[0].number)
            return [Block(BlockKind.FENCE, directive.lines, fence=replace(fence, skipped=directive.skipped))]
        inner = directive.body
        if style and not title and directive.argument:
            inner = [*_at(directive.lines, directive.argument, ""), *inner]
        return [Block(BlockKind(kind), directive.lines, self.inside(inner), title, style)]

    def _snippet(self, token: Token, lines: tuple[SourceLine, ...]) -> list[Block]:
        return self._blocks_of(token.info, lines)

    def _blocks_of(self, name: str, lines: tuple[SourceLine, ...]) -> list[Block]:
        """Return the blocks of an included file; a fence for a program, and for a file that is not there."""
        text, path = self.include(name), PurePosixPath(name.partition(":")[0])
        if text is None:
            return [fence_block(make_fence("", f'--8<-- "{name}"\n', lines[0].number), lines)]
        if path.suffix not in _TEXTS:
            info = f'{path.suffix[1:]} title="{path.name}"'
            return [fence_block(make_fence(info, text.rstrip("\n") + "\n", lines[0].number), lines)]
        # A file that includes itself, directly or not, is for itself not there.
        inner = _Reader(lambda other: None if other == name else self.include(other), self.depth + 1)
        return [
            replace(block, new=block.new or block.lines) if block.kind is BlockKind.TEXT else block
            for block in inner.blocks(_at(lines, *attributes.with_imports(text).split("\n")))
        ]

    def _container_any_open(self, token: Token, lines: tuple[SourceLine, ...]) -> list[Block]:
        name, argument = attributes.container_name(token.info)
        ends = set(lines[-1].text.strip()) in ({":"}, {"/"}) and len(lines) > 1
        inner = list(lines[1:-1] if ends else lines[1:])
        while token.markup.startswith("/") and inner and re.match(r" {4}\w+:", inner[0].text):
            inner.pop(0)
        options, skipped = attributes.options([line.text for line in inner])
        if name in _DIRECTIVES:
            return self._directive(name, argument, lines, inner, ends)
        is_myst = token.info.strip().startswith("{") and not token.info.strip().startswith("{.")
        kind, style, title = attributes.container(name, argument, colon=not is_myst)
        title = title or options.get("title", "") or quarto_title(name, inner)
        if style and not title and argument and is_myst:
            inner[:skipped] = _at(lines, argument, "")
            skipped = 0
        return [Block(BlockKind(kind or "group"), lines, self.inside(inner[skipped:]), title, style)]

    _container_slash_open = _container_any_open

    def _admonition_open(self, token: Token, lines: tuple[SourceLine, ...]) -> list[Block]:
        style, title = attributes.admonition(token.info)
        indent = len(lines[0].text) - len(lines[0].text.lstrip()) + 4
        kind = BlockKind.DETAILS if lines[0].text.lstrip().startswith("?") else BlockKind.ADMONITION
        return [Block(kind, lines, self.inside(dedented(lines[1:], indent)), title, style)]

    def _tab(self, token: Token, lines: tuple[SourceLine, ...]) -> list[Block]:
        return [Block(BlockKind.TAB, lines, self.inside(dedented(lines[1:], 4)), token.info)]

    def _callout(self, token: Token, lines: tuple[SourceLine, ...]) -> list[Block]:
        inner = (Block(BlockKind.TEXT, _at(lines, token.info)),)
        return [Block(BlockKind.ADMONITION, lines, inner, style="warning" if token.tag == "!" else "tip")]

    def _jsx(self, token: Token, lines: tuple[SourceLine, ...]) -> list[Block]:
        return [Block(BlockKind.TEXT, lines, new=_at(lines, token.content))]

    def _kramdown(self, token: Token, lines: tuple[SourceLine, ...]) -> list[Block]:
        title = "titled" if "-title" in token.info else ""
        return [Block(BlockKind.DROPPED, lines, title=title, style=attributes.kramdown_style(token.info))]

    def _label(self, token: Token, lines: tuple[SourceLine, ...]) -> list[Block]:
        return [Block(BlockKind.DROPPED, lines, label=token.tag)]

    def _dropped(self, token: Token, lines: tuple[SourceLine, ...]) -> list[Block]:
        return [Block(BlockKind.DROPPED, lines)]

    def _marked(self, token: Token, lines: tuple[SourceLine, ...], mark: str, name: str) -> list[Block]:
        return [Block(BlockKind.DROPPED, lines, title=name, style=mark, new=_at(lines, token.info))]

    def _liquid(self, token: Token, lines: tuple[SourceLine, ...]) -> list[Block]:
        if token.tag in {"include", "include_relative", "figure", "img", "image"}:
            properties = attributes.pairs(token.info)
            source = next((properties[key] for key in ("image_path", "src", "url", "file") if key in properties), "")
            if source:
                return [Block(BlockKind.TEXT, lines, new=_at(lines, attributes.image(source, properties)))]
            name = token.info.split(" ")[0].strip("\"'")
            return self._blocks_of(name, lines) if name.endswith(_CHAPTERS) else self._dropped(token, lines)
        if token.tag.startswith("end"):
            return self._marked(token, lines, "close", token.tag[3:])
        return self._marked(token, lines, "open", token.tag)

    def _tag_open(self, token: Token, lines: tuple[SourceLine, ...]) -> list[Block]:
        if token.content:
            token.info = f'title="{attributes.plain(token.content)}"'
        return self._marked(token, lines, "open", token.tag)

    def _tag_close(self, token: Token, lines: tuple[SourceLine, ...]) -> list[Block]:
        return self._marked(token, lines, "close", token.tag)

    def _tag_self(self, token: Token, lines: tuple[SourceLine, ...]) -> list[Block]:
        if token.tag == "summary":
            words = _at(lines, attributes.plain(token.content))
            return [Block(BlockKind.DROPPED, lines, title="summary", style="summary", new=words)]
        if token.content:
            return [self._one_line(token, lines)]
        if picture := attributes.picture(token.info):
            return [Block(BlockKind.TEXT, lines, new=_at(lines, picture))]
        # A component without content shows the words among its properties.
        return [Block(BlockKind.DROPPED, lines, new=_at(lines, *attributes.words_of(token.tag, token.info)))]

    def _one_line(self, token: Token, lines: tuple[SourceLine, ...]) -> Block:
        """Return the block of a component that opens and closes on its line."""
        inner = _at(lines, token.content.rpartition("</")[0].strip())
        kind, style, title = attributes.paired(token.tag, attributes.pairs(token.info), token.info)
        if kind == "group" and not title:
            return Block(BlockKind.TEXT, lines, new=inner)
        return Block(BlockKind(kind), lines, self.inside(inner), title, style)

    def _blockquote_open(self, token: Token, lines: tuple[SourceLine, ...]) -> list[Block]:
        return [Block(BlockKind.QUOTE, lines, self.inside([unquoted(line) for line in lines]))]

    def _bullet_list_open(self, token: Token, lines: tuple[SourceLine, ...]) -> list[Block]:
        items = self._items(lines)
        return [Block(BlockKind.LIST, lines, items)] if items else [Block(BlockKind.TEXT, lines)]

    _ordered_list_open = _bullet_list_open

    def _items(self, lines: tuple[SourceLine, ...]) -> tuple[Block, ...]:
        tokens = parser().parse("\n".join(line.text for line in lines))
        items = [token for token in tokens if token.type == "list_item_open" and token.level == 1 and token.map]
        starts = [(token.map or [0])[0] for token in items]
        return tuple(map(self._item, items, (lines[a:b] for a, b in itertools.pairwise([*starts, len(lines)]))))

    def _item(self, token: Token, lines: tuple[SourceLine, ...]) -> Block:
        offset = offset_of(lines[0].text, len(token.info) + len(token.markup))
        first = SourceLine(lines[0].text[offset:], lines[0].number)
        inner = self.inside([first, *dedented(lines[1:], offset)])
        return Block(BlockKind.ITEM, lines, inner, title=token.info, style=token.markup, offset=offset)


def read_blocks(text: str, include: Include) -> tuple[Block, ...]:
    """Return the blocks of a chapter's text."""
    text = unindented(attributes.with_imports(text))
    lines = [SourceLine(content, number) for number, content in enumerate(text.split("\n"), start=1)]
    return _Reader(include).blocks(lines)


#: MyST's directives, except those that hold blocks.
_DIRECTIVES: dict[str, Callable[[_Reader, Directive], list[Block]]] = {
    **dict.fromkeys(attributes.CODE, _Reader._code),
    **dict.fromkeys(attributes.UNSEEN, lambda reader, directive: [Block(BlockKind.DROPPED, directive.lines)]),
    "literalinclude": _Reader._literal,
    "include": lambda reader, directive: reader._blocks_of(directive.argument, directive.lines),
    "prompt": _Reader._prompt,
    "list-table": _Reader._list_table,
    "image": _Reader._image,
    "figure": _Reader._image,
    "mermaid": _Reader._mermaid,
    "math": _Reader._math,
}


def _inside(tokens: Sequence[Token], index: int) -> Iterator[Token]:
    """Return the tokens between an opening token and its closing token."""
    level = tokens[index].level
    return itertools.takewhile(lambda token: token.level > level, itertools.islice(tokens, index + 1, None))


def _at(lines: Sequence[SourceLine], *texts: str) -> tuple[SourceLine, ...]:
    """Return texts as lines in the place of the first of these lines."""
    return tuple(SourceLine(text, lines[0].number) for text in texts)
