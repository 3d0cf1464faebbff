"""`spinbook package`: the chapters' nodes as a ROS 2 package that colcon builds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import click

from interface_compiler.definition import Definition
from spinbook.chapter.chapter import Cell
from spinbook.chapters import read_all
from spinbook.course.course import FILE, Course, Package, find_course
from spinbook.interfaces.compiling import checked
from spinbook.package.files import Module
from spinbook.package.from_notebooks import read_notebooks
from spinbook.package.write import write_interface_packages, write_package
from spinbook.problem import Problem, SpinbookError


@click.command()
@click.option("--course", "start", type=click.Path(path_type=Path), default=".", help="The course's folder.")
@click.option("--workspace", type=click.Path(path_type=Path), help="Where to write. [default: as course.toml says]")
def package(start: Path, workspace: Path | None) -> None:
    """Write the chapters' nodes as a ROS 2 package, ready for colcon.

    \b
    Then:
      cd humanoid_ws
      colcon build --symlink-install
      ros2 run humanoid_control joint_publisher

    In a handout, where there are no chapters, the nodes are those of the notebooks, as you saved them.
    """
    made = _of_course(find_course(start)) if _is_course(start) else _of_notebooks(start)
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


@dataclass(frozen=True)
class Sources:
    """What a package is written from, and the folder where its workspace goes.

    `interfaces` are the names of the packages that `definitions` make; `files` are launch and parameter files.
    """

    root: Path
    package: Package
    modules: Sequence[Module]
    definitions: Sequence[Definition]
    interfaces: Sequence[str]
    files: Mapping[str, str] = field(default_factory=dict)


def _is_course(start: Path) -> bool:
    folder = start.resolve()
    return any((place / FILE).is_file() for place in (folder, *folder.parents))


def _of_course(course: Course) -> Sources:
    interfaces = checked(course)
    return Sources(
        course.root,
        course.package,
        course_modules(course),
        tuple(interfaces.definitions),
        tuple(interfaces.packages),
        course_files(course),
    )


def _of_notebooks(folder: Path) -> Sources:
    read = read_notebooks(folder)
    assert read.package is not None
    modules = [read.modules[name] for name in sorted(read.modules)]
    definitions = tuple(read.definitions.values())
    return Sources(folder, read.package, modules, definitions, sorted({item.package for item in definitions}))


def course_modules(course: Course) -> list[Module]:
    """Every node cell of the course as a module. Raises SpinbookError where two chapters' modules clash."""
    first: dict[str, tuple[Path, Cell]] = {}
    problems: list[Problem] = []
    for reading in read_all(course):
        problems += [problem for problem in reading.problems if problem.is_error]
        for cell in reading.chapter.nodes if reading.chapter else ():
            assert cell.name is not None
            assert reading.chapter is not None
            file, known = first.setdefault(cell.name, (reading.chapter.file, cell))
            if file == reading.chapter.file:
                # Shown again, changed: the file as it is in the end.
                first[cell.name] = (file, cell)
            elif known.whole != cell.whole:
                found = f"the node `{cell.name}` is also defined in {file}:{known.line}, with other code."
                fix = "Give one of them another file name: the package can hold only one module with each name."
                problems.append(Problem(reading.chapter.file, cell.line, found, fix))
    if problems:
        raise SpinbookError(*problems)
    return [Module(name, cell.whole) for name, (_, cell) in sorted(first.items())]


def course_files(course: Course) -> dict[str, str]:
    """Every launch and parameter file of the course: its path in the package -> its text.

    Raises SpinbookError where two chapters' files clash.
    """
    first: dict[str, tuple[Path, Cell]] = {}
    for reading in read_all(course):
        for cell in reading.chapter.files if reading.chapter else ():
            assert cell.name is not None
            assert reading.chapter is not None
            file, known = first.setdefault(cell.name, (reading.chapter.file, cell))
            if file == reading.chapter.file:
                first[cell.name] = (file, cell)
            elif known.source != cell.source:
                found = f"the file `{cell.name}` is also defined in {file}:{known.line}, with other text."
                raise SpinbookError(Problem(reading.chapter.file, cell.line, found, "Give one of them another name."))
    return {name: cell.source.rstrip("\n") + "\n" for name, (_, cell) in sorted(first.items())}
