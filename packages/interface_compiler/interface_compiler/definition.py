"""Interface definitions as data, and what can be wrong in them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

#: Folder and ending of a definition -> its number of `---` lines.
KINDS = {"msg": 0, "srv": 1, "action": 2}


@dataclass(frozen=True)
class Definition:
    """One interface as its author wrote it.

    `kind` is msg, srv or action. The text begins at `line` of `file`, counted from 1: `line` is 1
    for a file of its own, and greater for a code fence in a chapter.
    """

    package: str
    kind: str
    name: str
    text: str
    file: Path
    line: int = 1

    @property
    def full_name(self) -> str:
        """Such as `std_msgs/msg/String`."""
        return f"{self.package}/{self.kind}/{self.name}"

    @property
    def title_line(self) -> int | None:
        """The line with a fence's title, which contains the name; None for a file of its own."""
        return self.line - 1 or None

    @property
    def path(self) -> str:
        """Where its package keeps it, such as `msg/String.msg`."""
        return f"{self.kind}/{self.name}.{self.kind}"


@dataclass(frozen=True)
class Fault:
    """One thing to fix in one file: `line` counts from 1, and is None if it concerns the whole file."""

    file: Path
    line: int | None
    problem: str
    fix: str

    def __str__(self) -> str:
        place = f"{self.file}:{self.line}" if self.line is not None else f"{self.file}"
        return f"{place}: {self.problem}\n    {self.fix}"


class DefinitionError(Exception):
    """Raised for definitions that can't be compiled, with everything that is wrong in them."""

    def __init__(self, faults: Iterable[Fault]) -> None:
        self.faults = tuple(faults)
        super().__init__("\n".join(map(str, self.faults)))


class CompileError(Exception):
    """Raised when correct definitions can't be compiled on this machine. The message says what to do."""


def read_folder(folder: Path, relative_to: Path | None = None) -> tuple[list[Definition], list[Fault]]:
    """Return the definitions in `folder/PACKAGE/{msg,srv,action}/`, and the files among them that can't be read.

    Their `file` is relative to `relative_to`.
    """
    definitions: list[Definition] = []
    faults: list[Fault] = []
    for path in sorted(_definition_files(folder)):
        file = path.relative_to(relative_to) if relative_to else path
        kind = path.parent.name
        if path.suffix != f".{kind}":
            fix = f"Rename it to {path.stem}.{kind}, or move it to the folder {path.suffix[1:]}/."
            faults.append(Fault(file, None, f"the folder {kind}/ holds only .{kind} files.", fix))
            continue
        try:
            text = path.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            faults.append(Fault(file, None, f"it can't be read: {error}.", "Save it as UTF-8."))
            continue
        definitions.append(Definition(path.parents[1].name, kind, path.stem, text, file))
    return definitions, faults


def _definition_files(folder: Path) -> Iterator[Path]:
    for kind in KINDS:
        for path in folder.glob(f"*/{kind}/*"):
            if path.is_file() and path.suffix[1:] in KINDS:
                yield path


def by_package(definitions: Iterable[Definition]) -> dict[str, list[Definition]]:
    """Return the definitions of each package, sorted by path."""
    packages: dict[str, list[Definition]] = {}
    for definition in sorted(definitions, key=lambda item: (item.package, item.path)):
        packages.setdefault(definition.package, []).append(definition)
    return packages
