"""`python -m ros_in_python.turtlesim`: a picture of the turtlesim that is running."""

from __future__ import annotations

import sys
from pathlib import Path

import click

from ros_in_python.svg_file import SvgFile

_SECONDS = click.FloatRange(min=0)


@click.command()
@click.argument("out", type=SvgFile(), default="turtle.svg", metavar="[OUT.svg]")
@click.option("--still", is_flag=True, help="Draw the turtles where they are now; otherwise they drive again.")
@click.option("--timeout", default=5.0, show_default=True, type=_SECONDS, help="Seconds to look for the node.")
@click.option(
    "--listen",
    default=7.0,
    show_default=True,
    type=_SECONDS,
    help="Seconds in total to listen to a turtlesim that can't give a picture.",
)
@click.option("--node", default="/turtlesim", show_default=True, help="The node's full name.")
def turtle(out: Path, still: bool, timeout: float, listen: float, node: str) -> None:
    """Draw the turtles of the running turtlesim and what they have drawn."""
    # rclpy takes long to import, and --help does without.
    from ros_in_python.turtlesim.picture import NoPictureError, write

    try:
        world = write(out, timeout, listen, node, moves=not still)
    except NoPictureError as error:
        click.echo(str(error), err=True)
        sys.exit(1)
    turtles = ", ".join(each.name for each in world.turtles) or "no turtle"
    click.echo(f"{out}: {turtles}" + (f" ({world.incomplete})" if world.incomplete else ""))
