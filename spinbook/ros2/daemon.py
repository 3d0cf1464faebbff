"""`ros2 daemon`: there is none here, and these verbs say so."""

from __future__ import annotations

import click

from spinbook.ros2.cli import CONTEXT, Entry, Menu

daemon = Menu(
    name="daemon",
    entries={
        "start": Entry("spinbook.ros2.daemon:start", "Says that none is needed."),
        "status": Entry("spinbook.ros2.daemon:status", "Says that none is running."),
        "stop": Entry("spinbook.ros2.daemon:stop", "Says that none is running."),
    },
    help="""The ROS 2 installation's ros2 keeps a daemon that remembers the graph. Here each call looks for itself.

    \b
      ros2 daemon status
    """,
)

_WHY = "(none is needed: each command looks at the graph itself, so there is nothing to restart)"


@click.command(context_settings=CONTEXT)
def status() -> None:
    """Say that none is running.

    \b
      ros2 daemon status
    """
    click.echo(f"The daemon is not running {_WHY}")


@click.command(context_settings=CONTEXT)
def start() -> None:
    """Say that none is needed.

    \b
      ros2 daemon start
    """
    click.echo(f"The daemon has not been started {_WHY}")


@click.command(context_settings=CONTEXT)
def stop() -> None:
    """Say that none is running.

    \b
      ros2 daemon stop
    """
    click.echo(f"The daemon is not running {_WHY}")
