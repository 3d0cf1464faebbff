"""`ros2 launch`: finds a launch file, reads it, and runs what it describes."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

import click

from ros_in_python.example_robots import share_folders
from ros_in_python.launch import markup_file, python_file
from ros_in_python.launch.actions import DeclareLaunchArgument, LaunchDescription, LaunchIntrospector
from ros_in_python.launch.plan import WITHOUT_COMPOSABLE, LaunchPlan, arguments_of
from ros_in_python.launch.running import ProcessGroup
from ros_in_python.launch.substitutions import Context, text_of
from ros_in_python.ros2 import executables
from ros_in_python.ros2.cli import CONTEXT, CommandError

#: How launch files' names end.
SUFFIXES = (".py", ".yaml", ".yml", ".xml")


@click.command(context_settings=CONTEXT)
@click.option("-s", "--show-args", "--show-arguments", is_flag=True, help="Show the file's arguments; start nothing.")
@click.option("-n", "--noninteractive", is_flag=True, expose_value=False, help="Always so here.")
@click.option("-a", "--show-all-subprocesses-output", is_flag=True, expose_value=False, help="Always so here.")
@click.option("-p", "--print", "--print-description", "is_printed", is_flag=True, help="Print what is in the file.")
@click.option("--launch-prefix", metavar="COMMAND", help="A command to run the programs with, as in 'gdb --args'.")
@click.option("--launch-prefix-filter", metavar="REGEX", help="Use the prefix for executables with such names alone.")
@click.option(WITHOUT_COMPOSABLE, "left_out", is_flag=True, help="Leave out composable nodes; start all else.")
@click.argument("package_or_file")
@click.argument("words", nargs=-1, metavar="[LAUNCH_FILE] [NAME:=VALUE ...]")
def launch(
    show_args: bool,
    is_printed: bool,
    left_out: bool,
    package_or_file: str,
    words: tuple[str, ...],
    **prefix: str | None,
) -> None:
    """Start the nodes of a launch file, and end them all with Ctrl-C.

    \b
      ros2 launch humanoid_control humanoid.launch.py highest:=1.5
      ros2 launch src/humanoid_control/launch/humanoid.launch.yaml
      ros2 launch --show-args humanoid_control humanoid.launch.py

    It reads Python, YAML and XML files of nodes and other programs, with arguments, conditions, groups, other launch
    files, timers and events. What else ROS 2's own launch knows is refused by name.
    """
    cwd = Path.cwd()
    _source(cwd)
    file, rest = _find(package_or_file, words)
    arguments = _given(rest)
    arguments |= {name.replace("_", "-"): value for name, value in prefix.items() if value}
    if show_args or is_printed:
        with python_file.modules():
            description = read(file)
            if is_printed:
                click.echo(LaunchIntrospector().format_launch_description(description))
            else:
                _show(list(arguments_of(description.entities, read, file)))
        return
    raise click.exceptions.Exit(launch_file(file, arguments, cwd, left_out=left_out))


def launch_file(
    file: Path, arguments: dict[str, str], cwd: Path, parameters: Sequence[Any] = (), *, left_out: bool = False
) -> int:
    """Run what a file describes, with these `parameters` for every node; return 1 if a program died by itself.

    Composable nodes are an error, unless they are `left_out`. Raises `CommandError`.
    """
    with python_file.modules(), tempfile.TemporaryDirectory(prefix="launch_params_") as folder:
        description = read(file)
        plan = LaunchPlan(Path(folder), cwd, read, left_out)
        context = Context(dict(arguments), file=file.absolute(), parameters=list(parameters))
        try:
            steps = list(plan.steps(description.entities, context))
        except CommandError as refusal:
            raise CommandError(*_unused(arguments, description, context), refusal.message) from None
        if unused := list(_unused(arguments, description, context)):
            raise CommandError(*unused)
        return ProcessGroup(plan).run(steps)


def read(file: Path) -> LaunchDescription:
    """Return what a launch file describes. Raises `CommandError`."""
    return python_file.read(file) if file.suffix == ".py" else markup_file.read(file)


def _source(cwd: Path) -> None:
    """Use the packages of the workspace here, as after `source install/setup.bash`."""
    for near in executables.workspaces_near(cwd)[:1]:
        near.extend(os.environ)
    executables.add_own_prefix(os.environ)


def _find(first: str, words: Sequence[str]) -> tuple[Path, list[str]]:
    """Return the launch file and the words after it."""
    if not words or ":=" in words[0]:
        file = Path(first)
        if not file.is_file():
            raise CommandError(
                f"'{first}' is not a launch file. Name a package and a file in it, or the path of a file:",
                "  ros2 launch humanoid_control humanoid.launch.py",
            )
        return file, list(words)
    return _in_package(first, words[0]), list(words[1:])


def _in_package(package: str, name: str) -> Path:
    shares = share_folders(package)
    if not shares:
        raise CommandError(
            f"Package '{package}' not found", "Run `colcon build --symlink-install` in its workspace, and this there."
        )
    there = sorted(path for share in shares for suffix in SUFFIXES for path in share.rglob(f"*launch{suffix}"))
    found = [path for share in shares for path in sorted(share.rglob(name)) if path.is_file()]
    if not found:
        raise CommandError(
            f"file '{name}' was not found in the share directory of package '{package}'",
            f"Launch files there: {', '.join(path.name for path in there) or 'none'}.",
            "setup.py installs them: data_files has a line for share/PACKAGE/launch. Build again after a change of it.",
        )
    if len(found) > 1:
        raise CommandError(f"file '{name}' was found more than once:", *(f"- {path}" for path in found))
    return found[0]


def _given(words: Sequence[str]) -> dict[str, str]:
    arguments: dict[str, str] = {}
    for word in words:
        name, mark, value = word.partition(":=")
        if not mark or not name:
            raise CommandError(f"malformed launch argument '{word}', expected format '<name>:=<value>'")
        arguments[name] = value
    return arguments


def _unused(arguments: Iterable[str], description: LaunchDescription, context: Context) -> Iterator[str]:
    """Yield a sentence on each argument that was given, but neither declared nor asked for."""
    names = list(dict.fromkeys(argument.name for argument in arguments_of(description.entities, read, context.file)))
    for name in arguments:
        if name not in context.asked.union(names) and not name.startswith("launch-prefix"):
            yield f"the launch file has no argument '{name}'. It has: {', '.join(names) or 'none'}."


def _default(argument: DeclareLaunchArgument) -> str:
    try:
        return text_of(argument.default_value, Context())
    except CommandError:  # it needs another argument's value
        return "known when it runs"


def _described(argument: DeclareLaunchArgument) -> str:
    if argument.choices is None:
        return argument.description or "no description given"
    if not argument.description:
        return f"One of: {list(argument.choices)}"
    return f"{argument.description.removesuffix('.')}. Valid choices are: {list(argument.choices)}"


def _show(declared: Sequence[DeclareLaunchArgument]) -> None:
    """Print them as the real command does."""
    click.echo("Arguments (pass arguments as '<name>:=<value>'):")
    if not declared:
        click.echo("\n  No arguments.")
    for argument in declared:
        click.echo(f"\n    '{argument.name}':")
        click.echo(f"        {_described(argument)}")
        if argument.default_value is not None:
            click.echo(f"        (default: '{_default(argument)}')")
