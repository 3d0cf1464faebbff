"""Makes a chapter's notebook. The same chapter always gives the same bytes."""

from __future__ import annotations

import base64
import json
import mimetypes
import posixpath
import re
import shlex
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any
from urllib.parse import quote

import nbformat
import yaml
from markdown_it.token import Token

from grader.exercise.loading import load
from grader.exercise.starter import starter
from spinbook.chapter.attributes import container, container_name, options
from spinbook.chapter.chapter import Chapter, ChapterCell
from spinbook.chapter.classify import CellKind
from spinbook.chapter.fence import directive, parse_info
from spinbook.chapter.files import is_elsewhere, locate, split
from spinbook.chapter.flavours import parser
from spinbook.chapter.links import linked
from spinbook.chapter.terminal import Command, CommandKind
from spinbook.course.course import Course

_ALERT = re.compile(r"\[!(\w+)\][+-]?\s*(?P<title>.*)$")
#: MyST's roles that show their content: `{kbd}`Ctrl-C``, `{py:class}`~rclpy.node.Node``, `{term}`nodes <node>``.
_ROLE = re.compile(
    r"(?P<code>(?<![}`])(?P<mark>`+)(?!`).*?(?<!`)(?P=mark)(?!`))|\{(?P<role>[a-z][\w:.+-]*)\}(?P<ticks>`+)(?P<content>[^`]+)(?P=ticks)"
)
_TAGS_OF_ROLES = {"sub": "sub", "subscript": "sub", "sup": "sup", "superscript": "sup", "kbd": "kbd"}
#: Larger pictures stay out of the notebook, which is read and written as a whole.
_LARGEST_PICTURE = 4_000_000


@dataclass
class Location:
    """Where a piece of prose is from: the course's root, the folder of its file, and what its links may lead to.

    `notebooks` are what chapters are called, by their file. `pictures` collects the files that the prose shows: name of
    the attachment -> media type -> content in base 64. `file` is the chapter itself, where it is one. `references` are
    the chapter's definitions `[label]: target`: a notebook's cells do not share them.
    """

    root: Path
    folder: str
    notebooks: Mapping[Path, str] = field(default_factory=dict)
    repository: str = ""
    pictures: dict[str, dict[str, str]] = field(default_factory=dict)
    file: Path | None = None
    references: Mapping[str, Any] = field(default_factory=dict)

    def target(self, target: str, is_image: bool) -> str | None:
        """Return the target that a link or an image needs in a notebook; None leaves it as it is."""
        if is_elsewhere(target):
            return None
        file = locate(self.root, self.folder, target)
        _, anchor = split(target)
        if file is not None and file == self.file and anchor:
            return anchor
        if file is not None and file in self.notebooks:
            return quote(f"{self.notebooks[file]}.ipynb") + anchor
        if is_image and file is not None and (name := self._attached(file)):
            return f"attachment:{name}"
        if not self.repository:
            return quote(f"../../{file.as_posix()}") + anchor if file else None
        # Above the course's root is nothing that the repository's pages show.
        path = file.as_posix() if file else posixpath.normpath(f"/{self.folder}/{split(target)[0]}").lstrip("/")
        return f"{self.repository}/{'raw' if is_image else 'blob'}/main/{quote(path)}{anchor}"

    def _attached(self, file: Path) -> str:
        kind = mimetypes.guess_type(file.name)[0] or ""
        path = self.root / file
        if not kind.startswith("image/") or not path.is_file() or path.stat().st_size > _LARGEST_PICTURE:
            return ""
        name = re.sub(r"[^\w.-]+", "-", "-".join(file.parts[-2:]))
        self.pictures[name] = {kind: base64.b64encode(path.read_bytes()).decode()}
        return name


_FENCES = ("```", "~~~")
#: Without one of these, prose is plain Markdown: fences, alerts, containers.
_OF_BOOK_TOOLS = ("```", "~~~", "[!", ":::")


def portable(prose: str, location: Location) -> str:
    """Return the prose with alerts and admonitions as quotations, plain fences, and links that lead somewhere.

    Links to files of the course point into its repository, those to other chapters to their notebooks; pictures are
    collected in `location`.
    """
    if any(mark in prose for mark in _OF_BOOK_TOOLS):
        prose = "\n".join(_plain(prose.split("\n")))
    if "}`" in prose:
        prose = "\n".join(_without_roles(prose.split("\n")))
    return linked(prose, location.target, location.references)


def _without_roles(lines: Iterable[str]) -> Iterator[str]:
    """Yield the lines with the content of MyST's roles in place of them, outside fences and code in a line."""
    is_code = False
    for line in lines:
        is_code ^= line.lstrip(" >").startswith(_FENCES)
        yield line if is_code else _ROLE.sub(_in_words, line)


def _in_words(role: re.Match[str]) -> str:
    """Return a role's content as plain Markdown, maths between dollar signs; code as it is."""
    if role["code"]:
        return role[0]
    content, name = role["content"].strip(), role["role"]
    if name == "math":
        return f"${content}$"
    if tag := _TAGS_OF_ROLES.get(name):
        return f"<{tag}>{content}</{tag}>"
    if name in {"term", "abbr", "eq", "cite", "download"}:
        return content.partition(" <")[0]
    return f"`{content.lstrip('~!')}`"


def _plain(lines: list[str]) -> list[str]:
    """Return the lines without syntax that only book tools understand."""
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
    """Return (first line, line after the last, new lines) for a token that has to be rewritten."""
    start, end = token.map or (0, 0)
    if token.type == "fence":
        opening = _opening(token, lines[start])
        return (start, start + 1, opening) if opening != [lines[start]] else None
    if token.type == "blockquote_open":
        before, bracket, rest = lines[start].partition("[")
        alert = _ALERT.match(bracket + rest)
        if alert and not before.strip(" >"):
            title = alert["title"].strip() or alert[1].capitalize()
            return start, start + 1, [f"{before}**{title}**", before.rstrip()]
    if token.type == "container_any_open":
        first = lines[start].partition(":")[0]
        end += end < len(lines) and _is_end(lines[end], first)
        return start, end, _quotation(token, list(lines[start:end]), first)
    return None


def _opening(token: Token, line: str) -> list[str]:
    """Return an opening fence without attributes, its file name on the line above it."""
    if directive(token.info)[0] or not token.info.strip():
        name = directive(token.info)[0]
        return [line.replace(token.info, name)] if name else [line]
    before = line[: len(line) - len(token.info)]
    language, attributes = parse_info(token.info)
    written = token.info.strip().split(" ")[0].split("{")[0] or language
    indent = before[: len(before) - len(before.lstrip())] if not before.strip("`~ ") else ""
    plain = f"{before}{written}"
    return [f"{indent}`{attributes['title']}`:", "", plain] if "title" in attributes else [plain]


def _quotation(token: Token, lines: list[str], first: str) -> list[str]:
    """Return an admonition as a quotation with a bold title. `first` is the prefix of its first line, such as `- `."""
    rest = _below(first)
    ends = len(lines) > 1 and _is_end(lines[-1], first)
    name, argument = container_name(token.info)
    inner = [_without(rest, line) for line in (lines[1:-1] if ends else lines[1:])]
    _, skipped = options(inner)
    inner = _plain(inner[skipped:])
    kind, _, title = container(name, argument, colon=True)
    title = title or argument or name.capitalize()
    if kind in {"admonition", "details", None}:
        inner = [f"> **{title}**", ">", *(f"> {line}".rstrip() for line in inner)]
    return [f"{before}{line}".rstrip() for before, line in zip([first, *[rest] * len(inner)], inner, strict=False)]


def _below(first: str) -> str:
    """Return the prefix of the lines that follow a line with this prefix: `- > ` gives `  > `."""
    return re.sub(r"[^>\s]", " ", first)


def _without(before: str, line: str) -> str:
    """Return a line without this prefix; an empty line may lack the prefix's last spaces."""
    return line.removeprefix(before) if line.startswith(before) else line.removeprefix(before.rstrip())


def _is_end(line: str, first: str) -> bool:
    return set(_without(_below(first), line).strip()) == {":"}


_SETUP = """\
# Run this cell first: it gives the notebook its commands, such as %%node, %ros2, %plot and %stop.
%load_ext spinbook
%chapter {name} --package {package} --workspace {workspace}"""


def notebook_json(chapter: Chapter, course: Course) -> str:
    """Return the notebook as JSON: nbformat 4.5, keys sorted, newline at the end. Raises nbformat's ValidationError."""
    notebook = nbformat.from_dict(_notebook(chapter, course))
    nbformat.validate(notebook)
    return json.dumps(notebook, ensure_ascii=False, indent=1, sort_keys=True) + "\n"


def _notebook(chapter: Chapter, course: Course) -> dict[str, Any]:
    return {
        "nbformat": 4,
        "nbformat_minor": 5,
        "metadata": {
            "kernelspec": {"display_name": "Python 3 (ipykernel)", "language": "python", "name": "python3"},
            "language_info": {"name": "python", "file_extension": ".py", "mimetype": "text/x-python"},
            "title": chapter.title,
            "spinbook": {"chapter": chapter.file.as_posix()},
        },
        "cells": _cells(chapter, course),
    }


def _cells(chapter: Chapter, course: Course) -> list[dict[str, Any]]:
    setup = _SETUP.format(name=chapter.name, package=course.package.name, workspace=course.package.workspace)
    setup_cell = _code("spinbook-setup", setup, {"kind": "setup", "line": 1})
    folder = chapter.file.parent.as_posix()
    location = Location(course.root, folder, course.names, course.repository, {}, chapter.file, chapter.references)
    made: list[dict[str, Any]] = []
    for cell in chapter.cells:
        if cell.kind is CellKind.PROSE:
            made.append(_prose(cell.id, cell.source, cell.line, location))
        elif cell.kind is CellKind.EXERCISE:
            made += _exercise(cell, course)
        else:
            made.append(_runnable(cell))
    # The chapter's heading comes first, then what makes its cells work.
    above = bool(made) and chapter.cells[0].kind is CellKind.PROSE
    return [*made[:above], setup_cell, *made[above:]]


def _runnable(cell: ChapterCell) -> dict[str, Any]:
    metadata: dict[str, Any] = {"kind": cell.kind.value, "line": cell.line}
    if cell.kind is CellKind.NODE:
        metadata["node"] = cell.name
        source = f"%%node {cell.name}{_bounds(cell)}{_how(cell)}\n{cell.source}"
    elif cell.kind is CellKind.PART:
        source = f"%%part {cell.name}{'' if cell.runs_in_kernel else ' --keep'}\n{cell.shown}"
    elif cell.kind is CellKind.INTERFACE:
        metadata["interface"] = cell.name
        source = f"%%interface {cell.name}\n{cell.source}"
    elif cell.kind is CellKind.FILE:
        metadata["file"] = cell.name
        source = f"%%package_file {cell.name}\n{cell.source}"
    elif cell.kind is CellKind.SHELL:
        source = "\n".join(_shell_line(command, cell) for command in cell.commands)
    else:
        source = cell.shown
    if cell.before:
        metadata["above"] = cell.before.count("\n")
    if cell.expects_error:
        metadata["expects_error"] = True
    tags = dict.fromkeys([*cell.tags, *(["raises-exception"] if cell.raises else [])])
    return _code(cell.id, source, metadata, list(tags))


def _how(cell: ChapterCell) -> str:
    """Return the options that say how a node's code is started and completed."""
    words = [f"--class {name}" for name in cell.spin_classes]
    words += ["--main"] if cell.runs_main else []
    words += ["--keep"] if cell.keeps and not cell.shown_in else []
    words += [f"--of {shlex.quote(cell.shown_in.stem)}"] if cell.shown_in else []
    words += [f"--as {package}/{executable}" for package, executable in cell.executables]
    words += [f"--replaces {cell.replaces}"] if cell.replaces else []
    if cell.before:
        words.append(" ".join(["--after", *cell.after]) if cell.after else "--usual-imports")
    return "".join(f" {word}" for word in words)


def _bounds(cell: ChapterCell) -> str:
    """Return the options that say how long a cell shows or runs, and whether its errors are meant."""
    seconds = f" --seconds {cell.seconds:g}" if cell.seconds else ""
    until = f" --until {shlex.quote(cell.until)}" if cell.until else ""
    return seconds + until + (" --expect-error" if cell.expects_error else "")


def _shell_line(command: Command, cell: ChapterCell) -> str:
    if command.kind is CommandKind.NOTE:
        return command.text
    text = _in_one_line(command)
    program, _, rest = text.partition(" ")
    if command.kind is CommandKind.GRAPH:
        return "%graph"
    if command.kind is CommandKind.PLOT:
        return f"%plot {rest}" + (f" --seconds {cell.seconds:g}" if cell.seconds else "")
    return f"%{program}{_bounds(cell)} {rest}"


def _in_one_line(command: Command) -> str:
    """Return a command as a magic's line: YAML over several lines becomes YAML in one line."""
    if "\n" not in command.text:
        return command.text
    return shlex.join(_flowing(word) if "\n" in word else word for word in command.words)


def _flowing(value: str) -> str:
    try:
        flowing: str = yaml.safe_dump(yaml.safe_load(value), default_flow_style=True, width=float("inf"))
    except yaml.YAMLError:
        return " ".join(value.split())
    return flowing.strip()


#: Only in the notebook: a page has no such command.
_TRY = (
    "Run the cell above, then try your node out: `%try {0}` in a new cell plays what surrounds it in real time, and "
    "draws what your node does. When it does what you meant, check it:"
)


def _exercise(cell: ChapterCell, course: Course) -> Iterator[dict[str, Any]]:
    exercise = load(course.root / "exercises" / (cell.name or ""))
    location = Location(course.root, f"exercises/{exercise.name}", course.names, course.repository)
    yield _prose(f"{cell.id}-task", _one_level_down(exercise.task), cell.line, location)
    if exercise.solution_file is not None:
        module = exercise.file_name.removesuffix(".py")
        source = f"%%node {module}\n{starter(exercise.solution_file.read_text(encoding='utf-8'))}"
        metadata = {"kind": "exercise", "line": cell.line, "node": module, "exercise": exercise.name}
        yield _code(f"{cell.id}-starter", source, metadata)
        yield _prose(f"{cell.id}-try", _TRY.format(exercise.name), cell.line, location)
        # Not marked as the exercise's: its code is in the cell above.
        yield _code(f"{cell.id}-check", f"%check {exercise.name}", {"kind": "check", "line": cell.line})


def _one_level_down(task: str) -> str:
    """Return a task's headings, one level below the chapter's section in which it is."""
    lines = task.split("\n")
    for token in parser().parse(task):
        if token.type == "heading_open" and token.map and token.markup.startswith("#") and len(token.markup) < 6:
            lines[token.map[0]] = lines[token.map[0]].replace("#", "###", 1)
    return "\n".join(lines)


def _prose(cell_id: str, prose: str, line: int, location: Location) -> dict[str, Any]:
    location = replace(location, pictures={})
    source = portable(prose, location)
    metadata = {"spinbook": {"line": line}}
    cell: dict[str, Any] = {"cell_type": "markdown", "id": cell_id, "metadata": metadata, "source": source}
    return {**cell, "attachments": location.pictures} if location.pictures else cell


#: What JupyterLab folds -> the tags of MyST that fold or remove it on a page.
_HIDDEN = {
    "source_hidden": {"hide-input", "hide-cell", "remove-input", "remove-cell"},
    "outputs_hidden": {"hide-output", "hide-cell", "remove-output", "remove-cell"},
}


def _code(cell_id: str, source: str, metadata: dict[str, Any], tags: list[str] | None = None) -> dict[str, Any]:
    shown: dict[str, Any] = {"spinbook": metadata}
    if tags:
        shown["tags"] = tags
    if hidden := {name: True for name, words in _HIDDEN.items() if words & set(tags or ())}:
        shown["jupyter"] = hidden
    return {
        "cell_type": "code",
        "id": cell_id,
        "metadata": shown,
        "source": source.rstrip("\n"),
        "outputs": [],
        "execution_count": None,
    }
