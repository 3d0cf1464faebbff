"""`spinbook package`: the chapters' nodes as a ROS 2 package that colcon builds."""

from __future__ import annotations

from pathlib import Path

import click

from spinbook.build.reading import read_all
from spinbook.chapter.chapter import Cell
from spinbook.course.course import Course, find_course
from spinbook.interfaces.collect import checked
from spinbook.package.files import Module
from spinbook.package.write import write_package
from spinbook.package.write_interfaces import write_interface_packages
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
      spinbook ros2 run humanoid_control joint_publisher
    """
    course = find_course(start)
    modules, files = course_modules(course), course_files(course)
    target = workspace or course.root / course.package.workspace
    interfaces = checked(course)
    folder = write_package(target, course.package, modules, interfaces.packages, files)
    click.echo(f"{folder}: {len(modules)} modules")
    for module in modules:
        runs = f"ros2 run {course.package.name} {module.name}" if module.has_main else "(no main(): a module only)"
        click.echo(f"  {module.name}.py".ljust(28) + runs)
    for path in files:
        runs = f"ros2 launch {course.package.name} {path.rpartition('/')[2]}" if path.startswith("launch/") else ""
        click.echo(f"  {path}".ljust(28) + runs)
    for package_folder in write_interface_packages(target, course.package, interfaces.definitions):
        members = [item for item in interfaces.definitions if item.package == package_folder.name]
        click.echo(f"{package_folder}: {len(members)} interfaces")
        for item in sorted(members, key=lambda item: item.path):
            click.echo(f"  {item.path}".ljust(28) + f"ros2 interface show {item.full_name}")


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
                found = f"the node `{cell.name}` also stands in {file}:{known.line}, with other code."
                mend = "Give one of them another file name: the package can hold only one module of a name."
                problems.append(Problem(reading.chapter.file, cell.line, found, mend))
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
                found = f"the file `{cell.name}` also stands in {file}:{known.line}, with other text."
                raise SpinbookError(Problem(reading.chapter.file, cell.line, found, "Give one of them another name."))
    return {name: cell.source.rstrip("\n") + "\n" for name, (_, cell) in sorted(first.items())}
