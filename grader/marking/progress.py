"""How far a run is: a bar with the time left in a terminal, else a line a student."""

from __future__ import annotations

from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.text import Text

from grader.classroom import Entry
from grader.report.printable import printable


class Progressing:
    """Tells of each entry as it is done. Use it as a context manager."""

    def __init__(self, console: Console, total: int) -> None:
        self._console, self._total, self._done = console, total, 0
        self._bar = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            MofNCompleteColumn(),
            TimeElapsedColumn(),
            TextColumn("left"),
            TimeRemainingColumn(compact=True),
            console=console,
            disable=not console.is_terminal,
            transient=True,
        )
        self._task = self._bar.add_task("grading", total=total)

    def done(self, entry: Entry, changed: str) -> None:
        """One more is done; `changed` tells what a former grade was, where there was another one."""
        self._done += 1
        self._bar.update(self._task, advance=1)
        if self._console.is_terminal and not changed:
            return
        grade = entry.grade
        what = f"{grade.score:g} of {grade.points:g} points" if grade.outcome != "host-error" else "not graded"
        told = f"{self._done}/{self._total} {entry.student.id}: {changed or what}"
        if grade.outcome not in ("graded", "host-error") and not changed:
            told += f" ({grade.outcome})"
        self._console.print(Text(printable(told)), soft_wrap=True)

    def __enter__(self) -> Progressing:
        self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, fault: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._bar.stop()
