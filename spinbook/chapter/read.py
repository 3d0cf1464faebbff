"""Reads a chapter: the entry point of this package."""

from __future__ import annotations

import contextlib
import functools
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from groundwork.problem import Problem, Severity
from spinbook.chapter.block import Block, BlockKind, SourceLine
from spinbook.chapter.blocks import read_blocks
from spinbook.chapter.chapter import Chapter, ChapterCell, StaticFence, make_cells
from spinbook.chapter.classify import CellKind, ClassifiedFence, first_look, node_name, static, with_language
from spinbook.chapter.excerpts import excerpts, is_excerpt
from spinbook.chapter.fence import Fence, interface_of, interface_package
from spinbook.chapter.files import is_elsewhere, locate, read_included, split
from spinbook.chapter.interface_fields import own_definitions
from spinbook.chapter.labels import Heading, Label, References, headings, labels, words_of
from spinbook.chapter.layout import ChapterLayout, Piece
from spinbook.chapter.links import links_in, references_in
from spinbook.chapter.oversights import Anchors, macros, misspelt
from spinbook.chapter.own_packages import OwnPackages, named_files, own_packages
from spinbook.chapter.programs import Programs
from spinbook.chapter.shells import Shells
from spinbook.chapter.shown_interfaces import one_each, shown_interfaces
from spinbook.chapter.source import Source, read_source
from spinbook.chapter.surroundings import Surroundings

_OTHER_SYSTEM = re.compile(r"\b(windows|mac ?os|os ?x|powershell)\b", re.IGNORECASE)
_LINUX = re.compile(r"linux|ubuntu|wsl", re.IGNORECASE)
#: The tag of cells that a notebook has but that a build does not run: nbclient's own.
SKIPPED = "skip-execution"


@dataclass(frozen=True)
class ReadResult:
    """The result of reading a chapter's file: the chapter, unless an error stopped it, and all problems."""

    chapter: Chapter | None
    problems: tuple[Problem, ...]


@dataclass(frozen=True, eq=False)
class _ParsedChapter:
    source: Source | None
    blocks: tuple[Block, ...]
    problems: tuple[Problem, ...]
    changed: tuple[int, ...]
    """When its file and the included ones were last changed (ns)."""
    included: tuple[Path, ...] = ()

    @property
    def inner_blocks(self) -> Iterator[Block]:
        """All blocks, each before those in it, in order."""
        return (block for top in self.blocks for block in top.walk())

    @property
    def fences(self) -> Iterator[tuple[Block, Fence]]:
        """The fences, in order, with their blocks."""
        return ((block, block.fence) for block in self.inner_blocks if block.fence is not None)


#: What has been read in this process, by root and file.
_read: dict[tuple[Path, Path], _ParsedChapter] = {}


def read_chapter(root: Path, file: Path, surroundings: Surroundings) -> ReadResult:
    """Read the chapter at `root / file`. Never raises because of its content: every fault is a Problem."""
    parsed = _parse(root, file)
    problems = list(parsed.problems)
    if parsed.source is None:
        return ReadResult(None, tuple(problems))
    with own_definitions(surroundings.interfaces):
        classified, fence_problems, borrowed = _classify(parsed, file, surroundings)
    title, title_problems = _title(parsed, file)
    own = labels(parsed.blocks, file)
    sections = {heading.slug: heading for heading in headings(parsed.blocks)}
    references = References(root, file, {**surroundings.labels, **own}, surroundings.titles, sections)
    problems += [*fence_problems, *title_problems, *_references(parsed, surroundings, root, references)]
    problems.sort(key=lambda problem: (problem.line or 0, problem.problem))
    by_line = {item.fence.line: item for item in classified}
    pieces = ChapterLayout(by_line, surroundings.exercises).pieces(parsed.blocks)
    cells = tuple(
        replace(cell, source=references.resolved(cell.source)) if cell.kind is CellKind.PROSE else cell
        for cell in make_cells([*_heading(parsed, title), *pieces], by_line, borrowed)
    )
    shown_in = {cell.shown_in for several in borrowed.values() for cell in several if cell.shown_in}
    chapter = Chapter(
        name=surroundings.names.get(file, file.stem),
        file=file,
        title=title,
        summary=str(parsed.source.front_matter.get("summary", "")),
        week=str(parsed.source.front_matter.get("week", "")),
        cells=cells,
        uses=tuple(sorted(_uses(parsed, root, file) | shown_in)),
        references=references_in(parsed.source.text),
        static_fences=tuple(
            StaticFence(item.fence.line, item.fence.language, item.why, item.sign)
            for item in classified
            if item.is_static
        ),
    )
    return ReadResult(chapter, tuple(problems))


def definitions_of(root: Path, file: Path, own: str) -> Iterator[tuple[Fence, str]]:
    """Yield each fence of a chapter that defines an interface, with its path, such as `my_interfaces/msg/Pose.msg`.

    `own` is the package of interfaces for which the chapter names none.
    """
    for block, fence in _fences(_parse(root, file), own):
        if block.closed and (path := interface_of(fence, own)):
            yield fence, path


def _fences(parsed: _ParsedChapter, own: str) -> Iterator[tuple[Block, Fence]]:
    """Yield each block that is a fence, and the fence, with the interface that it defines."""
    titles = _interfaces(parsed, own)
    for block, fence in parsed.fences:
        yield block, replace(fence, interface=titles.get(fence.line, ""))


@functools.lru_cache(maxsize=512)
def _interfaces(parsed: _ParsedChapter, own: str) -> dict[int, str]:
    return shown_interfaces(parsed.blocks, parsed.source.text if parsed.source else "", own)


def modules_of(root: Path, file: Path) -> frozenset[str]:
    """Return the modules whose files a chapter shows: the titles of its fences."""
    files = (Path(fence.title or "") for _, fence in _parse(root, file).fences if fence.is_file)
    return frozenset(file.stem for file in files if file.stem.isidentifier())


def labels_of(root: Path, file: Path) -> dict[str, Label]:
    """Return what the labels of a chapter name."""
    return labels(_parse(root, file).blocks, file)


def headings_of(root: Path, file: Path) -> tuple[Heading, ...]:
    """Return the headings of a chapter."""
    return tuple(headings(_parse(root, file).blocks))


def text_of(root: Path, file: Path) -> str:
    """Return the text of a chapter, without its front matter; "" if it can't be read."""
    source = _parse(root, file).source
    return source.text if source else ""


def title_of(root: Path, file: Path) -> str:
    """Return the title of a chapter, as Markdown; "" if it can't be read."""
    parsed = _parse(root, file)
    return _title(parsed, file)[0] if parsed.source else ""


def _parse(root: Path, file: Path) -> _ParsedChapter:
    known = _read.get((root, file))
    if known is None or known.changed != _changed(root, [file, *known.included]):
        known = _read[root, file] = _parsed(root, file)
    return known


def _changed(root: Path, files: Iterable[Path]) -> tuple[int, ...]:
    """Return when files were last changed (ns)."""
    return tuple(path.stat().st_mtime_ns if (path := root / file).exists() else 0 for file in files)


def _parsed(root: Path, file: Path) -> _ParsedChapter:
    source, problems = read_source(root / file, file)
    if source is None:
        return _ParsedChapter(None, (), tuple(problems), _changed(root, [file]))
    folder = file.parent.as_posix()
    included: list[Path] = []
    blocks = read_blocks(source.text, lambda name: read_included(root, folder, name, included))
    changed = _changed(root, [file, *included])
    return _ParsedChapter(source, one_each(blocks), tuple(problems), changed, tuple(included))


def _classify(
    parsed: _ParsedChapter, file: Path, surroundings: Surroundings
) -> tuple[list[ClassifiedFence], list[Problem], dict[int, list[ChapterCell]]]:
    items: list[ClassifiedFence] = []
    not_executed: dict[int, ClassifiedFence] = {}
    own = interface_package(surroundings.package)
    repeated = excerpts([with_language(fence) for _, fence in parsed.fences])
    for_others = _for_other_systems(parsed.inner_blocks)
    for block, fence in _fences(parsed, own):
        item = first_look(fence, file, own) if block.closed else _unclosed(block, fence, file)
        if is_excerpt(item, repeated.get(fence.line, "")):
            item = static(fence, "it is a piece of a program of the chapter")
        if item.kind is CellKind.INTERFACE and (fault := surroundings.not_compiled.get((file, fence.first_code_line))):
            item = static(fence, "its definition is not compiled", fault, sign=fault.problem)
        if fence.line in for_others and item.kind is CellKind.SHELL:
            item = static(fence, "its tab is for another system")
        if SKIPPED in fence.tags:
            if item.kind in {CellKind.NODE, CellKind.SNIPPET, CellKind.SHELL}:
                not_executed[len(items)] = item
            item = static(fence, "its tags say that it is not run")
        items.append(_with_valid_seconds(item, file))
    problems = [problem for item in items for problem in item.problems]
    packages = own_packages(with_language(item.fence) for item in items)
    interfaces = frozenset(surroundings.interfaces)
    programs = Programs(file, _own(packages, surroundings, items), named_files(parsed.inner_blocks), interfaces)
    items = programs.decide(items)
    modules = surroundings.modules | {item.name for item in items if item.kind is CellKind.NODE and item.name}
    shells = Shells(
        file,
        surroundings.package,
        modules,
        packages,
        programs.named_files,
        has_exercise=any(block.kind is BlockKind.EXERCISE for block in parsed.inner_blocks),
        interfaces=interfaces,
        earlier_programs=functools.partial(surroundings.earlier_programs, file),
    )
    items = shells.decide(items)
    for number, item in not_executed.items():
        items[number] = replace(item, name=node_name(item, "", file)[0] if item.kind is CellKind.NODE else None)
    return items, problems + programs.problems + shells.problems, shells.borrowed


def _for_other_systems(blocks: Iterable[Block]) -> set[int]:
    """Return the lines of the fences in tabs for Windows or macOS: ROS 2 runs on Linux here."""
    tabs = (block for block in blocks if block.kind is BlockKind.TAB)
    others = (tab for tab in tabs if _OTHER_SYSTEM.search(tab.title) and not _LINUX.search(tab.title))
    return {inner.fence.line for tab in others for inner in tab.walk() if inner.fence is not None}


def _own(
    packages: OwnPackages, surroundings: Surroundings, items: Sequence[ClassifiedFence]
) -> dict[str, frozenset[str]]:
    """Map each package of the chapter or the course to the modules that fences show."""
    titles = {Path(item.fence.title).name.removesuffix(".py") for item in items if item.fence.title}
    modules = surroundings.modules | titles
    nodes = dict.fromkeys([surroundings.package, *packages.names], modules)
    return {"": modules, **nodes, **_kinds(surroundings)}


def _kinds(surroundings: Surroundings) -> dict[str, frozenset[str]]:
    """Map each package of the course's interfaces to its modules, such as `msg`."""
    pairs = [name.split("/")[:2] for name in surroundings.interfaces]
    return {package: frozenset(kind for of, kind in pairs if of == package) for package, _ in pairs}


def _unclosed(block: Block, fence: Fence, file: Path) -> ClassifiedFence:
    opening = block.lines[0].text.strip()
    text = f"the code fence that opens here (`{opening[:60]}`) is never closed."
    problem = Problem(file, fence.line, text, f"Close it with a line of its own: {opening[:3]}", Severity.NOT_RUN)
    return static(fence, "its fence is never closed", problem, sign="its fence is never closed.")


def _with_valid_seconds(item: ClassifiedFence, file: Path) -> ClassifiedFence:
    """Return the fence without its attribute `seconds` if that is not a time, and with a warning."""
    attributes = dict(item.fence.attributes)
    seconds = attributes.pop("seconds", "1")
    with contextlib.suppress(ValueError):
        if 0 < float(seconds) <= 600:
            return item
    fix = "Write a number of seconds, above 0 and up to 600. Until then it is left out."
    problem = Problem(file, item.fence.line, f"`seconds={seconds}` is not a time.", fix, Severity.WARNING)
    return replace(item, fence=replace(item.fence, attributes=attributes), problems=(*item.problems, problem))


def _references(
    parsed: _ParsedChapter, surroundings: Surroundings, root: Path, references: References
) -> Iterator[Problem]:
    file = references.file
    for block in parsed.inner_blocks:
        if block.kind is BlockKind.EXERCISE and block.title not in surroundings.exercises:
            known = ", ".join(sorted(surroundings.exercises)) or "none yet"
            problem = f"there is no exercise `{block.title}`."
            fix = f"The folder exercises/ holds: {known}."
            yield Problem(file, block.line, problem, fix, Severity.NOT_RUN)
    assert parsed.source is not None
    folder = file.parent.as_posix()
    yield from references.problems(parsed.blocks)
    yield from misspelt(parsed.inner_blocks, file, parsed.source.text)
    yield from macros(parsed.inner_blocks, file)
    for target, line in links_in(parsed.source.text):
        is_own = target.startswith("#")
        if (is_elsewhere(target) and not is_own) or "{" in target or references.is_label(target):
            continue
        place = file if is_own else locate(root, folder, target)
        if place is None:
            problem = f"a link leads to `{target}`, and there is no such file."
            fix = "Write the path relative to the chapter's folder."
            yield Problem(file, line, problem, fix, Severity.WARNING, group="files that are not there")
        elif (anchor := split(target)[1][1:]) and place in surroundings.titles and not references.has(anchor):
            fault = _anchors(_parse(root, place)).problem(anchor, target, place, file, line)
            yield from [fault] if fault else []


@functools.lru_cache(maxsize=512)
def _anchors(parsed: _ParsedChapter) -> Anchors:
    return Anchors(parsed.blocks)


def _uses(parsed: _ParsedChapter, root: Path, file: Path) -> set[Path]:
    """Return the files of the course that the chapter includes, or links to."""
    assert parsed.source is not None
    folder = file.parent.as_posix()
    targets = (target for target, _ in links_in(parsed.source.text) if not is_elsewhere(target))
    return {place for target in targets if (place := locate(root, folder, target))} | set(parsed.included)


def _heading(parsed: _ParsedChapter, title: str) -> list[Piece]:
    """Return a heading with the title if the title is only in the front matter, as Docusaurus and Jekyll expect."""
    headings = [block.lines for block in parsed.blocks if block.kind is BlockKind.HEADING]
    if any(lines[0].text.lstrip().startswith("# ") or len(lines) > 1 for lines in headings):
        return []
    return [Piece(SourceLine(f"# {title}", 1), heading=True), Piece(SourceLine("", 1))]


def _title(parsed: _ParsedChapter, file: Path) -> tuple[str, list[Problem]]:
    assert parsed.source is not None
    front = parsed.source.front_matter
    front_title = front.get("title") or front.get("sidebar_label")
    heading = next((block for block in parsed.blocks if block.kind is BlockKind.HEADING), None)
    if heading:
        return str(front_title or words_of(heading)), []
    fix = "Begin it with one line such as `# Nodes and Topics`."
    named = file.stem if file.stem.lower() not in {"index", "readme"} else file.parent.name or file.stem
    title = str(front_title or named.replace("-", " ").replace("_", " "))
    return title, [] if front_title else [Problem(file, 1, "the chapter has no heading.", fix, Severity.WARNING)]
