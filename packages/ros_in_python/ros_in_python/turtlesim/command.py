"""`python -m ros_in_python.turtlesim`: a picture of the turtlesim that is running."""

from __future__ import annotations

import sys
from pathlib import Path

import click

_SECONDS = click.FloatRange(min=0)


@click.command()
@click.argument(
    "out", type=click.Path(dir_okay=False, path_type=Path), default="turtle.png", metavar="[OUT.png|OUT.svg]"
)
@click.option(
    "--moving",
    type=click.Path(dir_okay=False, path_type=Path),
    metavar="OUT.svg",
    help="Also write an SVG with the turtles' movement, if they have moved.",
)
@click.option("--timeout", default=5.0, show_default=True, type=_SECONDS, help="Seconds to look for the node.")
@click.option(
    "--listen",
    default=7.0,
    show_default=True,
    type=_SECONDS,
    help="Seconds in total to listen to a turtlesim that can't give a picture.",
)
@click.option("--node", default="/turtlesim", show_default=True, help="The node's full name.")
def turtle(out: Path, moving: Path | None, timeout: float, listen: float, node: str) -> None:
    """Draw the turtles of the running turtlesim and what they have drawn."""
    # rclpy and matplotlib take long to import, and --help needs neither.
    from ros_in_python.turtlesim.picture import NoPictureError, write

    try:
        world = write(out, timeout, listen, node, moving)
    except NoPictureError as error:
        click.echo(str(error), err=True)
        sys.exit(1)
    turtles = ", ".join(each.name for each in world.turtles) or "no turtle"
    click.echo(f"{out}: {turtles}" + (f" ({world.incomplete})" if world.incomplete else ""))
