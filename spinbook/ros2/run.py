"""`ros2 run`."""

from __future__ import annotations

import os
import shlex
import shutil
import signal
import sys
from pathlib import Path

import click

from spinbook.ros2.cli import CONTEXT, CommandError


@click.command(context_settings={**CONTEXT, "ignore_unknown_options": True, "allow_interspersed_args": False})
@click.option("--prefix", metavar="COMMAND", help="A command to run the executable with, as in 'gdb --args'.")
@click.argument("package_name")
@click.argument("executable_name")
@click.argument("arguments", nargs=-1, type=click.UNPROCESSED)
def run(prefix: str | None, package_name: str, executable_name: str, arguments: tuple[str, ...]) -> None:
    """Start an executable of a package; a colcon workspace here need not be sourced.

    \b
      ros2 run turtlesim turtlesim_node
      ros2 run humanoid_control joint_publisher --ros-args -p use_sim_time:=true -r __node:=left
    """
    from spinbook.ros2.executables import find

    launch = find(package_name, executable_name, Path.cwd())
    command = [*(shlex.split(prefix) if prefix else []), *launch.argv, *arguments]
    program = shutil.which(command[0], path=launch.env.get("PATH"))
    if program is None:
        raise CommandError(f"'{command[0]}' can't be run: there is no such program.")
    _become(program, command, launch.env)


def _become(program: str, command: list[str], environment: dict[str, str]) -> None:
    """Replace this process, so that signals and the exit status are the node's own."""
    sys.stdout.flush()
    sys.stderr.flush()
    # Python ignores these two for itself; what it starts should not inherit that.
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    signal.signal(signal.SIGXFSZ, signal.SIG_DFL)
    try:
        os.execve(program, command, environment)
    except OSError as error:
        raise CommandError(
            f"{program} could not be started: {error.strerror}",
            "Its first line may name a Python that is gone: build the workspace again.",
        ) from None
