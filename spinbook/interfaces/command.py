"""`spinbook interfaces`: the messages, services and actions of a course, and packages of them to add."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from groundwork.problem import Problem
from interface_compiler import prefixes, shipped
from interface_compiler.definition import CompileError
from interface_compiler.wheel import install, is_current, needed, wheel
from spinbook.course.course import find_course
from spinbook.interfaces.definitions import FOLDER, collect, compile_course
from spinbook.problem import SpinbookError

_course = click.option("--course", "start", type=click.Path(path_type=Path), default=".", help="The course's folder.")


@click.group(context_settings={"help_option_names": ["-h", "--help"]})
def interfaces() -> None:
    """The messages, services and actions that a course defines, and packages of them that PyPI lacks.

    \b
      spinbook interfaces list             what this course defines, and what can be added
      spinbook interfaces build            compile what has changed; `spinbook build` does it too
      spinbook interfaces add nav2_msgs    compile a package into this environment, once
      spinbook interfaces wheels           wheels for students with this computer's processor
    """


@interfaces.command("list")
@_course
def list_(start: Path) -> None:
    """List what this course defines, with file and line, and which packages can be added."""
    try:
        collected = collect(find_course(start))
    except SpinbookError:
        collected = None
    for item in sorted(collected.definitions, key=lambda item: item.full_name) if collected else ():
        click.echo(f"{item.full_name}".ljust(48) + f"{item.file}:{item.line}")
    for package, state in _state().items():
        click.echo(f"{package}".ljust(48) + state)


def _state() -> dict[str, str]:
    """Return each package that comes with Spinbook, and whether it is installed."""
    installed = prefixes.packages(prefixes.installed())
    return {
        package: "installed" if package in installed else f"spinbook interfaces add {package}"
        for package in shipped.known()
    }


@interfaces.command()
@_course
def build(start: Path) -> None:
    """Compile the course's interfaces, if they have changed."""
    compiled = compile_course(find_course(start))
    if compiled is None:
        click.echo("This course defines no interfaces, or a sourced workspace has them.")
    else:
        click.echo(f"{'Compiled' if compiled.fresh else 'Unchanged'}: {', '.join(compiled.packages)}")


@interfaces.command()
@click.argument("packages", nargs=-1, required=True)
def add(packages: tuple[str, ...]) -> None:
    """Compile packages that come with Spinbook as definitions, and install them into this environment."""
    known = shipped.known()
    for package in packages:
        if package not in known:
            click.echo(f"There is no package {package!r} to add. There are: {', '.join(known)}.", err=True)
            click.echo(f"A course brings any other as definitions, in its folder {FOLDER}/{package}/.", err=True)
            sys.exit(1)
    for package in packages:
        try:
            for each in (*needed(package), package):
                _add(each)
        except CompileError as error:
            click.echo(str(error), err=True)
            sys.exit(1)


def _add(package: str) -> None:
    if is_current(package):
        click.echo(f"{package}: is installed")
        return
    # Printed before compiling, which may take minutes.
    click.echo(f"{package}: compiling {len(shipped.definitions(package))} interfaces")
    install(package)
    click.echo(f"{package}: compiled and installed")


@interfaces.command()
@_course
def wheels(start: Path) -> None:
    """Write wheels of the course's interfaces, for this computer's processor, into interfaces/wheels/.

    They fit every Python from 3.10 on. `spinbook handout` always includes wheels for the computer that it runs on. It
    also includes wheels for other processors that it finds there.
    """
    course = find_course(start)
    compiled = compile_course(course)
    if compiled is None:
        problem = Problem(Path(FOLDER), None, "this course defines no interfaces.", "See docs/interfaces.md.")
        raise SpinbookError(problem)
    folder = course.root / FOLDER / "wheels"
    folder.mkdir(parents=True, exist_ok=True)
    places = [(package, compiled.prefix) for package in compiled.packages]
    places += [(package, Path(sys.prefix)) for package in shipped.standard()]
    for name, content in (wheel(package, prefix) for package, prefix in places):
        (folder / name).write_bytes(content)
        click.echo(folder / name)
