"""How far an audit is, and how much time is left."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TaskID, TextColumn, TimeRemainingColumn


class Bar:
    """A bar on a terminal; elsewhere, such as in a log, a line for each tenth."""

    def __init__(self, console: Console, bar: Progress) -> None:
        self._console, self._bar = console, bar
        self._task: TaskID | None = None
        self._exercise = ""
        self._done, self._total = 0, 0

    def begin(self, exercise: str, total: int) -> None:
        """There are `total` things to try."""
        self._exercise, self._done, self._total = exercise, 0, total
        if self._console.is_terminal:
            self._task = self._bar.add_task(exercise, total=total)

    def done(self) -> None:
        """One of them is tried."""
        self._done += 1
        if self._task is not None:
            self._bar.update(self._task, advance=1)
        elif self._done * 10 // self._total > (self._done - 1) * 10 // self._total:
            self._console.print(f"{self._exercise}: {self._done} of {self._total}")


@contextmanager
def on(console: Console) -> Iterator[Bar]:
    """A bar on this console, which is gone again afterwards."""
    columns = (
        TextColumn("{task.description:<40.40}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        yield Bar(console, bar)
