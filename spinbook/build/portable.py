"""Makes a chapter's prose into Markdown that JupyterLab, VS Code and Colab show without extensions."""

from __future__ import annotations

import base64
import mimetypes
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import quote

from markdown_it.token import Token

from spinbook.chapter.attributes import container, container_name, options
from spinbook.chapter.fence import directive, parse_info
from spinbook.chapter.files import is_elsewhere, locate, split
from spinbook.chapter.flavours import parser
from spinbook.chapter.links import linked

_ALERT = re.compile(r"\[!(NOTE|TIP|IMPORTANT|WARNING|CAUTION)\]\s*$", re.IGNORECASE)
#: Larger pictures stay out of the notebook, which is read and written as a whole.
_LARGEST_PICTURE = 4_000_000


@dataclass
class Place:
    """Where a piece of prose is from: the course's root, the folder of its file, and what its links may lead to.

    `notebooks` are what chapters are called, by their file. `pictures` collects the files that the prose shows: name of
    the attachment -> media type -> content in base 64.
    """

    root: Path
    folder: str
    notebooks: Mapping[Path, str] = field(default_factory=dict)
    repository: str = ""
    pictures: dict[str, dict[str, str]] = field(default_factory=dict)

    def target(self, target: str, is_image: bool) -> str | None:
        """Where a link or an image leads to from a notebook; None: nowhere else than it says."""
        if is_elsewhere(target):
            return None
        file = locate(self.root, self.folder, target)
        _, anchor = split(target)
        if file is not None and file in self.notebooks:
            return quote(f"{self.notebooks[file]}.ipynb") + anchor
        if is_image and file is not None and (name := self._attached(file)):
            return f"attachment:{name}"
        if not self.repository:
            return quote(f"../../{file.as_posix()}") + anchor if file else None
        path = file.as_posix() if file else _joined(self.folder, split(target)[0])
        return f"{self.repository}/{'raw' if is_image else 'blob'}/main/{quote(path)}{anchor}"

    def _attached(self, file: Path) -> str:
        kind = mimetypes.guess_type(file.name)[0] or ""
        path = self.root / file
        if not kind.startswith("image/") or not path.is_file() or path.stat().st_size > _LARGEST_PICTURE:
            return ""
        name = re.sub(r"[^\w.-]+", "-", "-".join(file.parts[-2:]))
        self.pictures[name] = {kind: base64.b64encode(path.read_bytes()).decode()}
        return name


def portable(prose: str, place: Place) -> str:
    """The prose with alerts and admonitions as quotations, plain fences, and links that lead somewhere.

    Links to files of the course point into its repository, those to other chapters to their notebooks; pictures are
    collected in `place`.
    """
    return linked("\n".join(_plain(prose.split("\n"))), place.target)


def _joined(folder: str, path: str) -> str:
    parts: list[str] = []
    for part in f"{folder}/{path}".split("/"):
        if part == ".." and parts:
            parts.pop()
        elif part not in {"", ".", ".."}:
            parts.append(part)
    return "/".join(parts)


def _plain(lines: list[str]) -> list[str]:
    """Lines without what only book tools understand."""
    edits: list[tuple[int, int, list[str]]] = []
    done = 0
    for token in parser().parse("\n".join(lines)):
        if token.map is None or token.nesting < 0 or token.map[0] < done:
            continue
        edit = _edit(token, lines)
        if edit is not None:
            edits.append(edit)
            done = edit[1] if token.type == "container_any_open" else done
    for start, end, new in sorted(edits, reverse=True):
        lines = [*lines[:start], *new, *lines[end:]]
    return lines


def _edit(token: Token, lines: Sequence[str]) -> tuple[int, int, list[str]] | None:
    """(first line, line behind, new lines) for a token that needs other words."""
    start, end = token.map or (0, 0)
    if token.type == "fence":
        opening = _opening(token, lines[start])
        return (start, start + 1, opening) if opening != [lines[start]] else None
    if token.type == "blockquote_open":
        before, bracket, rest = lines[start].partition("[")
        alert = _ALERT.match(bracket + rest)
        if alert and not before.strip(" >"):
            return start, start + 1, [f"{before}**{alert[1].capitalize()}**", before.rstrip()]
    if token.type == "container_any_open" and not lines[start].partition(":")[0].strip():
        end += end < len(lines) and set(lines[end].strip()) == {":"}
        return start, end, _quotation(token, list(lines[start:end]))
    return None


def _opening(token: Token, line: str) -> list[str]:
    """An opening fence without attributes, its file name in a line above it."""
    if directive(token.info)[0] or not token.info.strip():
        name = directive(token.info)[0]
        return [line.replace(token.info, name)] if name else [line]
    before = line[: len(line) - len(token.info)]
    language, attributes = parse_info(token.info)
    written = token.info.strip().split(" ")[0].split("{")[0] or language
    indent = before[: len(before) - len(before.lstrip())] if not before.strip("`~ ") else ""
    plain = f"{before}{written}"
    return [f"{indent}`{attributes['title']}`:", "", plain] if "title" in attributes else [plain]


def _quotation(token: Token, lines: list[str]) -> list[str]:
    """An admonition as a quotation with its title in bold."""
    ends = set(lines[-1].strip()) == {":"} and len(lines) > 1
    name, argument = container_name(token.info)
    inner = lines[1:-1] if ends else lines[1:]
    _, skipped = options(inner)
    inner = _plain(inner[skipped:])
    kind, _, title = container(name, argument, colon=True)
    title = title or argument or name.capitalize()
    indent = lines[0].partition(":")[0]
    if kind not in {"admonition", "details", None}:
        return inner
    return [
        f"{indent}> **{title}**",
        f"{indent}>",
        *(f"{indent}> {line.removeprefix(indent)}".rstrip() for line in inner),
    ]
