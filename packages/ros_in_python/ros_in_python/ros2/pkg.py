"""`ros2 pkg`: list, executables, prefix and xml."""

from __future__ import annotations

import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import click

from ros_in_python.ros2 import executables as search
from ros_in_python.ros2.cli import CommandError, Menu, MenuEntry

pkg = Menu(
    name="pkg",
    entries={"create": MenuEntry("ros_in_python.ros2.create:create", "Make a new package.")},
    help="""List packages and their executables; a built colcon workspace here counts.

    \b
      ros2 pkg executables humanoid_control
    """,
)


@pkg.command(name="list")
def list_() -> None:
    """All packages.

    \b
      ros2 pkg list
    """
    for name in sorted({*search.everywhere(Path.cwd()), *search.BUILT_IN}):
        click.echo(name)


@pkg.command()
@click.argument("package_name", required=False)
@click.option("--full-path", is_flag=True, help="Each one's file.")
def executables(package_name: str | None, full_path: bool) -> None:
    """What `ros2 run` can start.

    \b
      ros2 pkg executables turtlesim
      turtlesim draw_square
      turtlesim mimic
      turtlesim turtle_teleop_key
      turtlesim turtlesim_node
    """
    packages = search.everywhere(Path.cwd())
    if package_name is not None and package_name not in packages and package_name not in search.BUILT_IN:
        raise CommandError(f"Package '{package_name}' not found", "`ros2 pkg list` shows those that are there.")
    for name in [package_name] if package_name else sorted({*packages, *search.BUILT_IN}):
        if not search.is_built_in(name, packages.get(name)):
            for path in search.in_prefix(packages[name], name):
                click.echo(str(path) if full_path else f"{name} {path.name}")
        else:
            for executable, module in search.BUILT_IN[name].items():
                click.echo(f"{sys.executable} -m {module}" if full_path else f"{name} {executable}")


@pkg.command()
@click.argument("package_name")
@click.option("--share", is_flag=True, help="The package's share folder in it.")
def prefix(package_name: str, share: bool) -> None:
    """Where a package is installed.

    \b
      ros2 pkg prefix std_msgs
      ros2 pkg prefix --share std_msgs
    """
    packages = search.everywhere(Path.cwd())
    if package_name not in packages and package_name not in search.BUILT_IN:
        raise CommandError("Package not found", "`ros2 pkg list` shows those that are there.")
    found = Path(packages.get(package_name, sys.prefix))
    click.echo(str(found / "share" / package_name if share else found))


@pkg.command()
@click.argument("package_name")
@click.option("-t", "--tag", help="Print only this tag's text, such as version.")
def xml(package_name: str, tag: str | None) -> None:
    """A package's package.xml, or one tag of it.

    \b
      ros2 pkg xml std_msgs
      ros2 pkg xml std_msgs --tag version
    """
    prefix = search.everywhere(Path.cwd()).get(package_name)
    file = prefix / "share" / package_name / "package.xml" if prefix else None
    if file is None or not file.is_file():
        raise CommandError("Package not found", "`ros2 pkg list` shows those that are there.")
    text = file.read_text(encoding="utf-8")
    if tag is None:
        click.echo(text.rstrip("\n"))
        return
    found = [element.text or "" for element in ElementTree.fromstring(text).iter(tag)]
    if not found:
        raise CommandError(f"No tag '{tag}' in {file}")
    for value in found:
        click.echo(value.strip())
