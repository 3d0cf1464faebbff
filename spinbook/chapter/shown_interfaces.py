"""The messages, services and actions that a chapter shows: which fence defines which one, of which package.

A fence's name is in its title, its first comment, the text before it or the heading above. Its package is in the name's
path, in the chapter's imports, or in what the chapter says about a package of interfaces.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace

from interface_compiler import prefixes, shipped
from interface_compiler.definition import KINDS
from interface_compiler.grammar import PRIMITIVES, usual_name
from spinbook.chapter.block import HOLDS_FILE, Block, BlockKind, SourceLine, as_fence
from spinbook.chapter.fence import Fence
from spinbook.chapter.installed_interfaces import is_someone_elses

#: A path. ASCII, because Chinese text has no spaces around it.
_FILE = re.compile(r"(?<![\w.:])(?:[\w.~${}-]+/)*[A-Z]\w*\.(?:msg|srv|action)\b(?![\w(/]|\.\w)", re.ASCII)
_PACKAGE = re.compile(r"[a-z][a-z0-9_]*")
#: Folders on the way to a package that are not packages.
_NOT_PACKAGES = frozenset({"src", "msg", "srv", "action", "interfaces", "ros2_ws", "ws"})
_IMPORT = re.compile(r"\bfrom\s+(\w+)\.(msg|srv|action)\s+import\s+(\([^)]*\)|[^\n#;]*)")
_TYPE = re.compile(r"\b([a-z]\w*)(?:/|::)(msg|srv|action)(?:/|::)([A-Z]\w*)\b(?!\.)")
#: What names a package of interfaces: `package.xml`, CMake, `ros2 pkg create`, text.
_NAMED_PACKAGE = re.compile(r"<name>\s*(\w+)\s*</name>|\bproject\(\s*(\w+)|\bpkg create\b([^\n]+)|`(\w+)/?`")
_OF_INTERFACES = re.compile(r"(?:.*_)?(?:interfaces?|msgs?|srvs?|actions?|messages|services)")
_LINE = re.compile(r"(?P<type>[A-Za-z][\w/]*)(?:<=\d+)?(?:\[[^\]]*\])?\s+[A-Za-z_]\w*\s*(?:=.*|\s.*)?")


@dataclass(frozen=True)
class _Name:
    """What an interface is called where it is shown; the package is "" if the name has none."""

    package: str
    kind: str
    name: str

    @property
    def title(self) -> str:
        """The path that names it in a fence's title."""
        return "/".join(filter(None, (self.package, self.kind, f"{self.name}.{self.kind}")))


@dataclass
class _Before:
    """The names in the text before a fence, and in the heading above it."""

    text: str = ""
    names: list[_Name] = field(default_factory=list)
    heading: list[_Name] = field(default_factory=list)

    def read(self, block: Block) -> None:
        text = "\n".join(line.text for line in block.lines)
        if block.kind is BlockKind.HEADING:
            self.text, self.names, self.heading = text, [], _names_in(text)
        elif text.strip():
            # After "`ros2 interface show …` prints:", a fence is what it prints.
            names = [] if "interface show" in text else _names_in(text)
            self.text, self.names = f"{self.text}\n{text}", names

    def pop(self) -> list[_Name]:
        """Return the names for the next fence, the most likely one last."""
        names = [*self.heading, *self.names]
        self.text, self.names, self.heading = "", [], []
        return names


@dataclass(frozen=True)
class _UnnamedFence:
    """A fence that nothing before it names, with the text before it, and what follows up to the next heading."""

    fence: Fence
    before: str
    after: list[str] = field(default_factory=list)


def shown_interfaces(blocks: Iterable[Block], text: str, own: str) -> dict[int, str]:
    """Map the line of each fence that defines an interface to its title, such as `my_interfaces/msg/Pose.msg`.

    `text` is the chapter's, and `own` the package of interfaces for which the chapter names none.
    """
    if not re.search(r"\.(?:msg|srv|action)\b", text):
        return {}
    packages = _Packages(text, own)
    before = _Before()
    names: dict[int, _Name] = {}
    unnamed: list[_UnnamedFence] = []
    section: list[_UnnamedFence] = []
    for block in (inner for top in blocks for inner in top.walk()):
        section = [] if block.kind is BlockKind.HEADING else section
        if block.kind in {BlockKind.TEXT, BlockKind.FENCE}:
            for item in section:
                item.after.extend(line.text for line in block.lines)
        if block.kind in {BlockKind.TEXT, BlockKind.HEADING}:
            before.read(block)
        elif block.kind in HOLDS_FILE and (in_title := _names_in(block.title)):
            before.names = in_title
        elif block.kind is BlockKind.FENCE and block.fence is not None and block.closed:
            words, candidates = before.text, before.pop()
            if name := _name_of(block.fence, candidates):
                names[block.fence.line] = packages.placed(name, block.fence)
            elif (block.fence.is_shell and (candidates := _names_in(block.fence.code))) or _is_listing(block.fence):
                before.names = candidates
            else:
                section = [*section, _UnnamedFence(block.fence, words)]
                unnamed.append(section[-1])
    for item in unnamed:
        if name := packages.meant(item, names.values()):
            names[item.fence.line] = name
    return {line: name.title for line, name in names.items()}


def one_each(blocks: Iterable[Block]) -> tuple[Block, ...]:
    """Return the blocks; a fence that shows several interfaces, each below a comment with its file, becomes several."""
    return tuple(part for block in blocks for part in _separated(block))


def _separated(block: Block) -> Iterator[Block]:
    fence = block.fence
    if fence is None or not block.closed or block.kind is not BlockKind.FENCE:
        yield replace(block, children=one_each(block.children)) if block.children else block
        return
    code = fence.code.split("\n")
    starts = [i for i, text in enumerate(code) if text.startswith(("#", "//")) and _names_in(text)]
    spans = itertools.pairwise([*starts, len(code)])
    parts = [(start, "\n".join(code[start:end]).rstrip() + "\n") for start, end in spans]
    if len(parts) < 2 or not all(is_definition(text, _names_in(text)[0].kind) for _, text in parts):
        yield block
        return
    for start, text in parts:
        part = replace(fence, code=text, line=fence.first_code_line + start - 1, skipped=0)
        lines = (SourceLine("", part.line), SourceLine("", part.line + text.count("\n")))
        yield replace(block, lines=lines, fence=part, new=as_fence(part, lines))


def is_definition(code: str, kind: str) -> bool:
    """Return whether text is certainly a definition of this kind: fields, constants and the right number of `---`."""
    lines = [line.partition("#")[0].strip() for line in code.split("\n")]
    lines = [line for line in lines if line]
    fields = [line for line in lines if line != "---"]
    return len(lines) - len(fields) == KINDS[kind] and bool(lines) and all(map(_is_field, fields))


def _has_plain_field(code: str) -> bool:
    types = (re.split(r"[\[<\s]", line.strip(), maxsplit=1)[0] for line in code.split("\n"))
    return any(name in PRIMITIVES or re.fullmatch(r"[a-z]\w*/\w+", name) for name in types)


def _is_field(line: str) -> bool:
    match = _LINE.fullmatch(line)
    if match is None:
        return False
    name = match["type"]
    return name in PRIMITIVES or bool(usual_name(name)) or "/" in name or name[0].isupper()


def _name_of(fence: Fence, before: list[_Name]) -> _Name | None:
    """Return the name of the interface that a fence defines: by its title, its first comment or the text before."""
    if fence.has("static"):
        return None
    if fence.title:
        is_file = _FILE.fullmatch(fence.title) and "-" not in fence.title
        return _split(fence.title) if is_file else None
    commented = [_names_in(line) for line in fence.code.split("\n") if line.lstrip().startswith(("#", "//"))]
    commented = [names for names in commented if names]
    if len(commented) > 1:
        # Several files in one fence.
        return None
    names = [*before, *(commented[0] if commented else [])]
    return next((name for name in reversed(names) if is_definition(fence.code, name.kind)), None)


def _names_in(text: str) -> list[_Name]:
    return [_split(match[0]) for match in _FILE.finditer(text)]


def _split(path: str) -> _Name:
    *folders, file = path.split("/")
    name, _, kind = file.rpartition(".")
    folders = _in_repository(folders)
    folders = folders[:-1] if folders and folders[-1] == kind else folders
    package = folders[-1] if folders else ""
    return _Name("" if package in _NOT_PACKAGES or not _PACKAGE.fullmatch(package) else package, kind, name)


def _in_repository(folders: list[str]) -> list[str]:
    """Return the folders of a file from its repository on, if they are those of its address on GitHub or GitLab."""
    for mark in ("blob", "tree", "raw"):
        if mark in folders[1:]:
            at = folders.index(mark, 1)
            return [part for part in (folders[at - 1], *folders[at + 2 :]) if part != "-"]
    is_raw = folders[:1] == ["raw.githubusercontent.com"]
    return [*folders[2:3], *folders[4:]] if is_raw else folders


def _is_listing(fence: Fence) -> bool:
    """Return whether a fence shows files or an empty line, and not what the text before it announces."""
    return not fence.code.strip() or "──" in fence.code


class _Packages:
    """The packages of interfaces that a chapter mentions."""

    def __init__(self, text: str, own: str) -> None:
        self._own = own
        self._types = dict(_types_in(text))
        places = [*_packages_in(text), *((match[1], match.start()) for match in _IMPORT.finditer(text))]
        foreign = {name for name in {name for name, _ in places} if is_someone_elses(name, own)}
        self._places = sorted((text.count("\n", 0, at) + 1, name) for name, at in places if name not in foreign)

    def placed(self, name: _Name, fence: Fence) -> _Name:
        """Return the name with its package; without one, it belongs to the course."""
        package = name.package or self._types.get((name.kind, name.name)) or self._near(fence.line)
        return _Name(package or _twin(name, fence.code), name.kind, name.name)

    def meant(self, item: _UnnamedFence, known: Iterable[_Name]) -> _Name | None:
        """Return the interface that a fence without a name defines: the only one of its kind that the text mentions.

        The text before it mentions one that is imported; what follows names its file, in CMake, or imports it.
        """
        fence = item.fence
        if fence.is_python or fence.is_shell or fence.has("static") or fence.title or "interface show" in item.before:
            return None
        kinds = [kind for kind in KINDS if is_definition(fence.code, kind) and _has_plain_field(fence.code)]
        taken = {(name.kind, name.name) for name in known}
        used = [name for name in self._types if re.search(rf"\b{name[1]}\b", item.before)]
        after = "\n".join(line.partition("#")[0] for line in item.after)
        used = used or list(dict.fromkeys([*((n.kind, n.name) for n in _names_in(after)), *dict(_types_in(after))]))
        names = [_Name("", *name) for name in used if name[0] in kinds and name not in taken]
        meant = self.placed(names[0], fence) if len(names) == 1 else None
        return meant if meant and not is_someone_elses(meant.package, self._own) else None

    def _near(self, line: int) -> str:
        """Return the package of interfaces last mentioned before a line, otherwise the first one after it."""
        above = [name for at, name in self._places if at <= line]
        return above[-1] if above else next((name for _, name in self._places), "")


def _packages_in(text: str) -> Iterator[tuple[str, int]]:
    """Yield the packages of interfaces that a text names as packages, each with its place."""
    for match in _NAMED_PACKAGE.finditer(text):
        for word in next(filter(None, match.groups())).split():
            if _OF_INTERFACES.fullmatch(word) and word not in _NOT_PACKAGES:
                yield word, match.start()


def _types_in(text: str) -> Iterator[tuple[tuple[str, str], str]]:
    """Yield ((kind, name), package) of each type in a text; what Python imports comes last, and wins."""
    for match in _TYPE.finditer(text):
        yield (match[2], match[3]), match[1]
    for match in _IMPORT.finditer(text):
        for word in match[3].strip("()").split(","):
            if name := re.match(r"\s*(\w+)", word):
                yield (match[2], name[1]), match[1]


def _twin(name: _Name, code: str) -> str:
    """Return the package that has exactly this definition already; "" if there is none."""
    for package in shipped.standard():
        for item in shipped.definitions(package):
            if (item.kind, item.name) == (name.kind, name.name) and _fields(item.text) == _fields(code):
                return package
    for package, there in prefixes.interfaces(prefixes.installed()).items():
        if f"{name.kind}/{name.name}" in there and (prefix := prefixes.prefix_of(package, prefixes.installed())):
            text = prefixes.definitions_of(package, prefix).get(f"{name.kind}/{name.name}.{name.kind}", "")
            if _fields(text) == _fields(code):
                return package
    return ""


def _fields(text: str) -> list[str]:
    """Return a definition's lines as far as their types and names go, for a comparison."""
    lines = (" ".join(line.partition("#")[0].split()) for line in text.split("\n"))
    return [re.sub(r"^\w+/", "", line) for line in lines if line]
