"""The ROS packages that a chapter makes: their names, files and executables.

They are read from `ros2 pkg create`, a `setup.py` in the chapter, file paths, and the sentences that name files.
"""

from __future__ import annotations

import argparse
import itertools
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field

from markdown_it import MarkdownIt

from ros_in_python.ros2.create import reader
from spinbook.chapter.block import HOLDS_FILE, Block, BlockKind
from spinbook.chapter.fence import Fence
from spinbook.chapter.terminal import programs_of

_ENTRY = re.compile(r"""["']\s*([\w.-]+)\s*=\s*([\w.]+):(\w+)\s*["']""")
#: The same in setup.cfg and pyproject.toml.
_PLAIN_ENTRY = re.compile(r"""^\s*([\w.-]+)\s*=\s*["']?([\w.]+):(\w+)["']?,?\s*$""", re.MULTILINE)
_HAS_ENTRIES = re.compile(r"console_scripts|entry_points|\[project\.scripts\]")
_PACKAGE_NAME = re.compile(r"""\b(?:package_name|name)\s*=\s*["']([a-z][a-z0-9_]*)["']""")
_PACKAGE_VARIABLE = re.compile(r"""\{package_name\}|["']\s*\+\s*package_name\s*\+\s*["']""")
_MARKDOWN = MarkdownIt("commonmark")
_FILE_COMMENT = re.compile(r"""^\s*(?:#+|\"\"\"|''')\s*(?:[Ff]ile(?:name)?\s*:?\s*)?`?([\w./~-]+\.py)\b""")
_PY_FILE = re.compile(r"[\w./~-]*\w\.py\b", re.ASCII)
_EDITORS = frozenset({"touch", "nano", "vim", "vi", "gedit", "code", "cat"})
#: Files of a package that are not programs.
_NOT_PROGRAMS = frozenset({"setup.py", "__init__.py", "conftest.py"})


@dataclass(frozen=True)
class OwnPackages:
    """A chapter's packages. `executables` maps (package, executable) to the module, without .py."""

    names: frozenset[str] = frozenset()
    executables: dict[tuple[str, str], str] = field(default_factory=dict)
    compiled: frozenset[str] = frozenset()
    """The packages that `ros2 pkg create` makes for C++."""


def own_packages(fences: Iterable[Fence]) -> OwnPackages:
    """Return the packages that these fences make or show."""
    names: set[str] = set()
    compiled: set[str] = set()
    executables: dict[tuple[str, str], str] = {}
    for fence in fences:
        if fence.title and (package := _package_of(fence.title)):
            names.add(package)
        if "ros2 pkg create" in fence.code:
            for name, build_type in _created(fence.code):
                (compiled if build_type in {"ament_cmake", "cmake"} else names).add(name)
        if _HAS_ENTRIES.search(fence.code) or _ENTRY.search(fence.code):
            entries, shown = _entries(_with_package(fence.code, names))
            executables.update(entries)
            names |= shown
    return OwnPackages(frozenset(names | compiled), executables, frozenset(compiled))


def is_setup_excerpt(code: str) -> bool:
    """Return whether code is a setup.py, or the part of one that names executables, however it is cut out."""
    return bool(_HAS_ENTRIES.search(code) or _ENTRY.search(code)) and "rclpy" not in code


@dataclass(frozen=True)
class NewPackage:
    """What `ros2 pkg create …` makes; `name` is "" if the command can't run, `node` if it makes none.

    `unknown` are the words that are no options of it.
    """

    name: str = ""
    build_type: str = "ament_python"
    node: str = ""
    unknown: tuple[str, ...] = ()


def create_options() -> list[str]:
    """Return the options of `ros2 pkg create`."""
    return sorted(re.findall(r"--[\w-]+", reader().format_usage()))


def new_package(words: Sequence[str]) -> NewPackage:
    """Read `ros2 pkg create …` as it reads itself."""
    try:
        options, unknown = reader(exit_on_error=False).parse_known_args(words[3:])
    except argparse.ArgumentError:
        return NewPackage()
    return NewPackage(options.package_name, options.build_type, options.node_name, tuple(unknown))


def _created(code: str) -> Iterator[tuple[str, str]]:
    for words in programs_of(code):
        if words[:3] == ("ros2", "pkg", "create"):
            package = new_package(words)
            if re.fullmatch(r"[a-z][a-z0-9_]*", package.name):
                yield package.name, package.build_type


def _with_package(code: str, names: set[str]) -> str:
    """Return a setup.py with the package's name in place of its variable: in an f-string, or between two `+`."""
    named = {match[1] for match in _PACKAGE_NAME.finditer(code)} or names
    return _PACKAGE_VARIABLE.sub(named.copy().pop(), code) if len(named) == 1 else code


def _entries(code: str) -> tuple[dict[tuple[str, str], str], set[str]]:
    executables: dict[tuple[str, str], str] = {}
    names = {match[1] for match in _PACKAGE_NAME.finditer(code)} if "setup(" in code else set()
    plain = _PLAIN_ENTRY.findall(code) if _HAS_ENTRIES.search(code) else []
    for executable, module, _ in [*_ENTRY.findall(code), *plain]:
        package, _, stem = module.rpartition(".")
        package = package.partition(".")[0]
        if package:
            names.add(package)
            executables[package, executable] = stem
    return executables, names


def _package_of(path: str) -> str:
    """Return the package in a path such as src/my_robot/my_robot/talker.py."""
    parts = [part for part in path.split("/")[:-1] if part not in {"", ".", "..", "~"}]
    if "src" in parts and parts.index("src") + 1 < len(parts):
        name = parts[parts.index("src") + 1]
    else:
        name = next((a for a, b in itertools.pairwise(parts) if a == b), "")
    return name if re.fullmatch(r"[a-z][a-z0-9_]*", name) else ""


def named_files(blocks: Iterable[Block]) -> dict[int, str]:
    """Map the line of a fence to its Python file, as named in its first comment or in the text just before it.

    `blocks` are all of a chapter, also those in others.
    """
    files: dict[int, str] = {}
    words: list[str] = []
    for block in blocks:
        if block.kind in {BlockKind.TEXT, BlockKind.HEADING}:
            text = "\n".join(line.text for line in block.lines)
            if text.strip():
                words = _files_in(text)
        elif block.kind in HOLDS_FILE and block.title.endswith(".py"):
            words = [block.title]
        elif block.kind is BlockKind.FENCE and block.fence is not None:
            fence = block.fence
            if fence.is_shell:
                words = _edited(fence) or words
                continue
            message = _in_comment(fence.code) or (words[-1] if words else "")
            if message and message.rsplit("/", 1)[-1] not in _NOT_PROGRAMS:
                files[fence.line] = message
            words = []
    return files


def _in_comment(code: str) -> str:
    for line in code.split("\n")[:4]:
        if match := _FILE_COMMENT.match(line):
            return match[1]
    return ""


def _files_in(text: str) -> list[str]:
    if ".py" not in text:
        return []
    tokens = _MARKDOWN.parse(text)
    contents = [child.content for token in tokens for child in token.children or []]
    return [match for content in contents for match in _PY_FILE.findall(content)]


def _edited(fence: Fence) -> list[str]:
    return [word for words in programs_of(fence.code) if words[0] in _EDITORS for word in words if word.endswith(".py")]
