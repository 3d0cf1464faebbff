"""The `ros2` command line: nouns and verbs, errors for people, and how it ends on Ctrl-C."""

from __future__ import annotations

import difflib
import functools
import importlib
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from types import FrameType
from typing import Any, NoReturn, TypeVar, cast

import click

CONTEXT = {"help_option_names": ["-h", "--help"], "max_content_width": 100}

F = TypeVar("F", bound=Callable[..., Any])


@dataclass(frozen=True)
class MenuEntry:
    """A noun or a verb: where its click command is (`module:name`), and its line in the help."""

    place: str
    help: str


class Menu(click.Group):
    """A group whose errors say what there is. Its help lists `entries`, which are elsewhere, without importing any."""

    def __init__(self, *, entries: Mapping[str, MenuEntry] | None = None, **attributes: Any) -> None:
        super().__init__(context_settings=CONTEXT, **attributes)
        self.entries = entries or {}

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        if not args and not ctx.resilient_parsing:
            # As the real command: help is not an error.
            click.echo(ctx.get_help())
            ctx.exit(0)
        return super().parse_args(ctx, args)

    def list_commands(self, ctx: click.Context) -> list[str]:
        return sorted([*self.entries, *self.commands])

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        if cmd_name not in self.entries:
            return super().get_command(ctx, cmd_name)
        module, _, name = self.entries[cmd_name].place.partition(":")
        command = getattr(importlib.import_module(module), name)
        assert isinstance(command, click.Command)
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl([(name, self._summary(name)) for name in self.list_commands(ctx)])

    def _summary(self, name: str) -> str:
        if name in self.entries:
            return self.entries[name].help
        return (self.commands[name].help or "").partition("\n")[0]

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        names = self.list_commands(ctx)
        if args and not args[0].startswith("-") and args[0] not in names:
            close = difflib.get_close_matches(args[0], names, n=1)
            meant = f" Did you mean '{close[0]}'?" if close else ""
            raise click.UsageError(
                f"there is no '{ctx.command_path} {args[0]}' here.{meant}\n"
                f"There is: {', '.join(names)}.\n"
                "Other commands need a ROS 2 installation, whose own ros2 is then used by itself.",
                ctx,
            )
        return super().resolve_command(ctx, args)


def show_names(names: Sequence[str], only_count: bool) -> None:
    """Print the names, one per line, or only how many there are."""
    for line in [str(len(names))] if only_count else names:
        click.echo(line)


def discovery_options(command: F) -> F:
    """Add the real command's options for discovery: the function gets `spin_time` and `use_sim_time`."""
    for option in (
        click.option("-s", "--use-sim-time", is_flag=True, help="Take the time from /clock."),
        click.option("--no-daemon", is_flag=True, expose_value=False, help="Always so here: there is no daemon."),
        click.option(
            "--spin-time",
            type=click.FloatRange(min=0, min_open=True),
            metavar="N",
            help="End discovery after N seconds.",
        ),
    ):
        command = option(command)
    return command


def stdin_option(argument: str) -> Callable[[F], F]:
    """Add `--stdin`: the function gets the standard input's text as this argument."""

    def add(command: F) -> F:
        @click.option("--stdin", "reads", is_flag=True, help="Read the values from the standard input.")
        @functools.wraps(command)
        def run(*arguments: Any, reads: bool, **named: Any) -> Any:
            return command(*arguments, **{**named, argument: sys.stdin.read()} if reads else named)

        return cast("F", run)

    return add


class CommandError(click.ClickException):
    """A message for the person at the terminal; the process exits with 1, like the real command's. The first line has
    the real command's words if it has any; further lines say what exists and what to do.
    """

    exit_code = 1

    def __init__(self, *lines: str) -> None:
        super().__init__("\n".join(lines))

    def show(self, file: object = None) -> None:
        """Print the lines on standard error, without a prefix."""
        sys.stdout.flush()
        click.echo(self.message, err=True)


#: The real command's exit status after Ctrl-C (it passes on the number of the signal).
EXIT_AFTER_SIGINT = int(signal.SIGINT)


class StopSignal(KeyboardInterrupt):
    """Raised in the main thread when SIGINT or SIGTERM came."""

    def __init__(self, number: int) -> None:
        super().__init__()
        #: Exit status: 2 after SIGINT as the real command's, 0 after SIGTERM.
        self.exit_code = EXIT_AFTER_SIGINT if number == signal.SIGINT else 0


def listen() -> None:
    """Make SIGINT and SIGTERM raise `StopSignal`, for a command, of which a page's process runs several.

    SIGINT is set even where it was ignored (a shell ignores it for what it starts in the background), because a
    notebook stops its commands with it. Cleaning up is not interrupted by a second SIGINT soon afterwards; a SIGTERM
    during it ends the process at once. What hangs all the same is ended by SIGALRM.
    """
    if threading.current_thread() is not threading.main_thread():
        return
    global _stopped_at
    _stopped_at = None
    signal.signal(signal.SIGINT, _stop)
    signal.signal(signal.SIGTERM, _stop)
    sys.unraisablehook = _raise_again


def exit_code_of(error: BaseException) -> int | None:
    """Return the exit status after a signal; None if this error has nothing to do with one.

    Code in C that calls Python may make another error of the `StopSignal` that it gets: ImportError, TypeError.
    """
    if isinstance(error, StopSignal):
        return error.exit_code
    is_ours = isinstance(error, click.ClickException | click.exceptions.Exit) or not isinstance(error, Exception)
    return None if is_ours or _stopped_at is None else EXIT_AFTER_SIGINT


@contextmanager
def held_back() -> Iterator[None]:
    """Hold back the first signal until the end of the block, which then raises `StopSignal`; a second raises at once.

    For work inside rclpy: raised while its C++ makes a message, an exception comes out as a TypeError or not at all.
    """
    _held.append(None)
    try:
        yield
    finally:
        number = _held.pop()
    if number is not None:
        _raise(number)


#: After this time (s), a second SIGINT is raised too: the first may have been lost in a callback from C.
_PATIENCE_S = 2.0
#: How long cleaning up may take (s).
_AT_MOST_S = 30.0
# When a signal was raised (s); None if none was.
_stopped_at: float | None = None
# For each block that holds signals back, the number of the one that has come.
_held: list[int | None] = []


def _stop(number: int, frame: FrameType | None) -> None:
    if _held and _held[-1] is None:
        _held[-1] = number
    elif _stopped_at is None or time.monotonic() - _stopped_at > _PATIENCE_S:
        _raise(number)


def _raise(number: int) -> NoReturn:
    global _stopped_at
    _stopped_at = time.monotonic()
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    if hasattr(signal, "setitimer"):  # a page has none
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        signal.setitimer(signal.ITIMER_REAL, _AT_MOST_S)
    raise StopSignal(number)


def _raise_again(lost: sys.UnraisableHookArgs) -> None:
    """Raise a signal once more that came in a destructor or a callback, where Python drops exceptions."""
    if isinstance(lost.exc_value, StopSignal):
        listen()
        threading.Timer(0.01, os.kill, (os.getpid(), signal.SIGINT)).start()
    else:
        sys.__unraisablehook__(lost)
