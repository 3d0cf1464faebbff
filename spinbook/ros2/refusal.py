"""What the command answers when it can't do what was asked."""

from __future__ import annotations

import sys

import click


class Refusal(click.ClickException):
    """A message for the person at the terminal; the process ends with 1, as the real command's does.

    The first line has the real command's words where it has any; further lines say what is there and what to do.
    """

    exit_code = 1

    def __init__(self, *lines: str) -> None:
        super().__init__("\n".join(lines))

    def show(self, file: object = None) -> None:
        """Print the lines on standard error, without a prefix."""
        sys.stdout.flush()
        click.echo(self.message, err=True)
