"""The shape of the command line: `ros2 NOUN VERB`, each loaded when it is used."""

from __future__ import annotations

import difflib
import importlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, TypeVar

import click

CONTEXT = {"help_option_names": ["-h", "--help"], "max_content_width": 100}

F = TypeVar("F", bound=Callable[..., Any])


@dataclass(frozen=True)
class Entry:
    """A noun or a verb: where its click command is (`module:name`), and its line in the help."""

    place: str
    help: str


class Menu(click.Group):
    """A group whose help lists its entries without importing any, and whose errors say what there is."""

    def __init__(self, *, entries: Mapping[str, Entry], **attributes: Any) -> None:
        super().__init__(context_settings=CONTEXT, **attributes)
        self.entries = entries

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        if not args and not ctx.resilient_parsing:
            # As the real command: help is no error.
            click.echo(ctx.get_help())
            ctx.exit(0)
        return super().parse_args(ctx, args)

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(self.entries)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in self.entries:
            return None
        module, _, name = self.entries[cmd_name].place.partition(":")
        command = getattr(importlib.import_module(module), name)
        assert isinstance(command, click.Command)
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl([(name, entry.help) for name, entry in self.entries.items()])

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        if args and not args[0].startswith("-") and args[0] not in self.entries:
            close = difflib.get_close_matches(args[0], self.entries, n=1)
            meant = f" Did you mean '{close[0]}'?" if close else ""
            raise click.UsageError(
                f"there is no '{ctx.command_path} {args[0]}' here.{meant}\n"
                f"There is: {', '.join(self.entries)}.\n"
                "Other commands need a ROS 2 installation, whose own ros2 is then used by itself.",
                ctx,
            )
        return super().resolve_command(ctx, args)


def discovery_options(command: F) -> F:
    """The options of the real command that concern discovery: `spin_time` and `use_sim_time` reach the function."""
    for option in (
        click.option("-s", "--use-sim-time", is_flag=True, help="Take the time from /clock."),
        click.option("--no-daemon", is_flag=True, expose_value=False, help="Always so here: there is no daemon."),
        click.option(
            "--spin-time",
            type=click.FloatRange(min=0, min_open=True),
            metavar="N",
            help="Give discovery N seconds and no more.",
        ),
    ):
        command = option(command)
    return command
