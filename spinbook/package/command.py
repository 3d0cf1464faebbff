"""`spinbook package`: the chapters' nodes as a ROS 2 package that colcon builds."""

from __future__ import annotations

import contextlib
import os
import shlex
from argparse import Namespace
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import click

from grader.submission.notebook import read_notebook
from grader.submission.problems import Unreadable
from groundwork.problem import Problem
from interface_compiler.definition import Definition
from spinbook.chapter.chapter import Chapter, ChapterCell
from spinbook.chapter.complete_program import join
from spinbook.chapter.fence import interface_path
from spinbook.chapter.python_code import CodeError
from spinbook.chapters import read_all
from spinbook.course.course import Course, Package, course_folder, find_course
from spinbook.interfaces.definitions import checked
from spinbook.package.cell_line import CellFailed, chapter_reader, node_reader, split
from spinbook.package.files import Module
from spinbook.package.workspace import without_interfaces, write_interface_packages, write_package
from spinbook.problem import SpinbookError, refuse_errors


@dataclass
class Notebooks:
    """What the cells of notebooks make: a package, its modules by name, and definitions of interfaces by path."""

    package: Package | None = None
    modules: dict[str, Module] = field(default_factory=dict)
    definitions: dict[str, Definition] = field(default_factory=dict)
    code: dict[str, str] = field(default_factory=dict)
    """The code of each `%%node` and `%%part`, by its name: what `--after` refers to."""


def read_notebooks(folder: Path) -> Notebooks:
    """Read every notebook of a folder, in order of names. Raises SpinbookError if none is a chapter's."""
    read = Notebooks()
    for file in sorted(folder.glob("*.ipynb")):
        read.code.clear()
        try:
            for cell in read_notebook(file.read_bytes()).cells:
                _take(read, cell.source, file)
        except (OSError, Unreadable) as error:
            raise SpinbookError(Problem(file, None, str(error), "Save it again in JupyterLab.")) from None
        except CellFailed as error:
            problem = f"the cell `{cell.source.split(chr(10))[0]}` can't run, so it makes no node: {error}"
            raise SpinbookError(Problem(file, None, problem, "Correct it, and save the notebook.")) from None
    if read.package is None:
        problem = "there is no course.toml and no notebook of a course here."
        raise SpinbookError(Problem(folder, None, problem, "Go into a course's folder, or into a handout's."))
    return read


def _take(read: Notebooks, source: str, file: Path) -> None:
    """Add what a cell makes. Raises CellFailed, as the cell itself does, if its magic is wrong."""
    for line in source.split("\n"):
        if line.startswith("%chapter "):
            chapter = chapter_reader().parse_args(split(line)[1:])
            read.package = Package(chapter.package, chapter.workspace)
    first, _, code = source.partition("\n")
    magic, _, line = first.partition(" ")
    if magic == "%%part":
        read.code["".join(word for word in split(line) if word != "--keep")] = code
    elif magic == "%%interface" and read.package:
        _take_interface(read, "".join(split(line)[:1]), code, file)
    elif magic == "%%node" and not {"-h", "--help"} & set(split(line)):
        node = node_reader().parse_args(split(line))
        name = node.name.removesuffix(".py")
        read.code[name] = code
        read.modules[name] = _module(name, node, code, read)


def _take_interface(read: Notebooks, title: str, text: str, file: Path) -> None:
    assert read.package is not None
    path = interface_path(title, f"{read.package.name}_interfaces")
    if path is not None:
        package, kind, name = path.split("/")
        body = text.rstrip("\n") + "\n" if text.strip() else ""
        read.definitions[path] = Definition(package, kind, name.rpartition(".")[0], body, file)


def _module(name: str, node: Namespace, code: str, read: Notebooks) -> Module:
    """Return the complete module of a `%%node` cell, with the code that `--after` and `--usual-imports` add."""
    whole = code
    if node.after or node.usual_imports:
        pieces = [read.code[piece] for piece in node.after if piece in read.code]
        with contextlib.suppress(CodeError):  # Python itself reports best what is wrong.
            whole = join(code, pieces).whole
    pairs = [known.partition("/") for known in node.known_as]
    own = read.package.name if read.package else ""
    executables = tuple(executable for package, _, executable in pairs if package == own)
    return Module(name, whole.rstrip("\n") + "\n", executables)


@click.command()
@click.option("--course", "start", type=click.Path(path_type=Path), default=".", help="The course's folder.")
@click.option("--workspace", type=click.Path(path_type=Path), help="Where to write. [default: as in course.toml]")
def package(start: Path, workspace: Path | None) -> None:
    """Write the chapters' nodes as a ROS 2 package, and say how colcon builds it.

    In a handout, where there are no chapters, the nodes are those of the notebooks, as you saved them.
    """
    made = _of_course(find_course(start)) if course_folder(start) else _of_notebooks(start)
    target = workspace or made.root / made.package.workspace
    folder = write_package(target, made.package, made.modules, made.interfaces, made.files)
    click.echo(f"{folder}: {len(made.modules)} modules")
    for module in made.modules:
        runs = f"ros2 run {made.package.name} {module.name}" if module.has_main else "(no main(): a module only)"
        click.echo(f"  {module.name}.py".ljust(28) + runs)
    for path in made.files:
        runs = f"ros2 launch {made.package.name} {path.rpartition('/')[2]}" if path.startswith("launch/") else ""
        click.echo(f"  {path}".ljust(28) + runs)
    for package_folder in write_interface_packages(target, made.package, made.definitions):
        members = [item for item in made.definitions if item.package == package_folder.name]
        click.echo(f"{package_folder}: {len(members)} interfaces")
        for item in sorted(members, key=lambda item: item.path):
            click.echo(f"  {item.path}".ljust(28) + f"ros2 interface show {item.full_name}")
    build = shlex.join(["colcon", "build", "--symlink-install", *without_interfaces(target)])
    click.echo(f"Build:\n  cd {shlex.quote(os.fspath(target))}\n  {build}\n  source install/setup.bash")


@dataclass(frozen=True)
class PackageSources:
    """Everything that a package is made from, and the folder of its workspace.

    `interfaces` are the names of the packages that `definitions` make; `files` are launch and parameter files.
    """

    root: Path
    package: Package
    modules: Sequence[Module]
    definitions: Sequence[Definition]
    interfaces: Sequence[str]
    files: Mapping[str, str] = field(default_factory=dict)


def _of_course(course: Course) -> PackageSources:
    interfaces = checked(course)
    return PackageSources(
        course.root,
        course.package,
        [Module(name, code) for name, code in _texts(course, "node", lambda chapter: chapter.nodes).items()],
        tuple(interfaces.definitions),
        tuple(interfaces.packages),
        course_files(course),
    )


def _of_notebooks(folder: Path) -> PackageSources:
    read = read_notebooks(folder)
    assert read.package is not None
    modules = [read.modules[name] for name in sorted(read.modules)]
    definitions = tuple(read.definitions.values())
    return PackageSources(folder, read.package, modules, definitions, sorted({item.package for item in definitions}))


def course_files(course: Course) -> dict[str, str]:
    """Return every launch and parameter file of the course: its path in the package -> its text.

    Raises SpinbookError if two chapters' files clash.
    """
    texts = _texts(course, "file", lambda chapter: chapter.files)
    return {name: text.rstrip("\n") + "\n" for name, text in texts.items()}


def _texts(course: Course, noun: str, cells_of: Callable[[Chapter], Iterable[ChapterCell]]) -> dict[str, str]:
    """Return the texts of these cells of the course by their names, sorted. Raises SpinbookError."""
    first: dict[str, tuple[Path, ChapterCell]] = {}
    readings = list(read_all(course))
    problems = [problem for reading in readings for problem in reading.problems]
    for chapter in (reading.chapter for reading in readings if reading.chapter):
        for cell in cells_of(chapter):
            name = cell.name or ""
            file, known = first.setdefault(name, (chapter.file, cell))
            if file == chapter.file:
                # The chapter shows the file several times: the last version counts.
                first[name] = (file, cell)
            elif known.whole != cell.whole:
                problem = f"the {noun} `{name}` is also defined in {file}:{known.line}, with other text."
                fix = "Give one of them another name: the package can hold only one file with each name."
                problems.append(Problem(chapter.file, cell.line, problem, fix))
    refuse_errors(problems)
    return {name: cell.whole for name, (_, cell) in sorted(first.items())}
