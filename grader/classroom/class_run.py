"""Grades a class, from the folder of submissions to the gradebook, and shows the progress."""

from __future__ import annotations

import contextlib
import signal
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import FrameType, TracebackType

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.prompt import Confirm
from rich.text import Text

from grader.classroom.collecting import collect
from grader.classroom.deadline import Adjusting, Deadline, deadline_of, overrides_in
from grader.classroom.gradebook import gradebook, unknown_to_moodle, write_gradebook
from grader.classroom.handed_in import HandedIn, Question, Submissions, SubmissionsError
from grader.classroom.local import LocalBackend, at_once
from grader.classroom.misconceptions import Signature, failures_of, grouped, signatures
from grader.classroom.overview import overview_page
from grader.classroom.publishing import publish
from grader.classroom.rejudging import difference, rejudge
from grader.classroom.request import Backend, ClassRequest, host_error
from grader.classroom.results import ClassGrading, Plan, Results, not_written
from grader.exercise.exercise import Exercise
from grader.grading.grade import Entry, Grade, Skipped
from grader.grading.grading import Grading, grading_of
from grader.report.printable import printable
from grader.submission.reading import Submission, read
from grader.workers.pool import WorkerPool
from groundwork.files import write_if_changed

#: How many files that were skipped for the same reason are named; the overview page names all.
MOST_NAMED = 5


def show_submissions(console: Console, kind: str, count: int, skipped: Sequence[Skipped]) -> None:
    """Print how the submissions were read, and what was left out."""
    _say(console, f"{count} submissions in {kind}.")
    reasons: dict[str, list[str]] = {}
    for one in skipped:
        reasons.setdefault(one.why, []).append(one.file)
    for why, files in reasons.items():
        more = f" and {len(files) - MOST_NAMED} more" if len(files) > MOST_NAMED else ""
        _say(console, f"skipped, {why}: {', '.join(files[:MOST_NAMED])}{more}", "yellow")


def show_result(
    console: Console, entries: Sequence[Entry], faults: Sequence[Entry], questions: Sequence[Question]
) -> None:
    """Print the class's result, and what is left to do for the instructor."""
    finals = sorted(entry.final for entry in entries if entry.final is not None)
    if finals:
        points = entries[0].grade.points
        middle = (finals[(len(finals) - 1) // 2] + finals[len(finals) // 2]) / 2
        full = sum(final >= points for final in finals)
        _say(console, f"{len(finals)} grades: median {middle:g} of {points:g} points, {full} with full marks.", "bold")
    if entries and (unknown := unknown_to_moodle(entries)):
        who = "any student" if unknown == len(entries) else f"{unknown} of the {len(entries)} students"
        _say(
            console,
            f"moodle.csv has no Identifier for {who}, so Moodle can't match them. If you use Moodle, grade the folder "
            "that you downloaded from it, or a CSV file with the column Identifier.",
            "dim",
        )
    for question in questions:
        _say(console, f"not graded: {question} Keep one of them, or name it in a CSV file.", "yellow")
    for entry in faults:
        _say(
            console,
            f"not graded, because of a fault of Spinbook or the machine: {entry.student.id}: {entry.grade.message}",
            "red",
        )
    if faults:
        _say(console, "Run the same command to try them again.", "red")


def _say(console: Console, text: str, style: str = "") -> None:
    console.print(Text(printable(text), style=style), soft_wrap=True)


class ProgressDisplay:
    """Prints each entry as it is done. Use it as a context manager."""

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
        """Count one more as done; `changed` says what an earlier grade was, if it was different."""
        self._done += 1
        self._bar.update(self._task, advance=1)
        if self._console.is_terminal and not changed:
            return
        grade = entry.grade
        what = f"{grade.score:g} of {grade.points:g} points" if grade.outcome != "host-error" else "not graded"
        text = f"{self._done}/{self._total} {entry.student.id}: {changed or what}"
        if grade.outcome not in ("graded", "host-error") and not changed:
            text += f" ({grade.outcome})"
        self._console.print(Text(printable(text)), soft_wrap=True)

    def __enter__(self) -> ProgressDisplay:
        self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, fault: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._bar.stop()


#: Exit codes, besides click's 2 for usage and a shell's 130 for Ctrl-C.
DONE, QUESTIONS, FAULTS, STOPPED = 0, 1, 3, 130


def grade_class(exercise: Exercise, class_request: ClassRequest, console: Console) -> int:
    """Grade a class, and print the result; return the exit code.

    Raises `SubmissionsError` when there is nothing to grade, `OverridesError` for a mistake in the overrides, `Busy`
    when another run is using the same results folder, and what `grading_of` raises.
    """
    with tempfile.TemporaryDirectory(prefix="spinbook-class-") as unpacked, _ended_by_signals():
        collected = collect(class_request.source, exercise.name, Path(unpacked))
        show_submissions(console, collected.kind, len(collected.handed_in), collected.skipped)
        adjusting = _adjusting(exercise, class_request, {one.student.id for one in collected.handed_in})
        submissions, unreadable = _read(collected, exercise)
        collected = replace(
            collected, handed_in=tuple(one for one in collected.handed_in if one.student.id in submissions)
        )
        with Results(class_request.out) as results, WorkerPool(class_request.options.middleware) as workers:
            grading = grading_of(exercise, class_request.options, workers)
            with _backend(grading, class_request) as markers:
                marking = ClassGrading(exercise, markers, results, adjusting, grading)
                if class_request.rejudge:
                    rejudge(
                        marking, grading, collected, submissions, console, partial(_may_replace, class_request, console)
                    )
                    marking.take_in(collected)
                    return _finish(marking, grading, collected, console, adjusting.deadline, class_request.publish)
                plan = marking.plan(
                    collected, submissions, lambda who: "*" in class_request.regrade or who in class_request.regrade
                )
                for one, error in unreadable:
                    marking.give_up(Entry(one.student, one.file.name, _unread(grading, one)), f"reading it: {error}")
                try:
                    _grade(marking, plan, submissions, console)
                    return _finish(marking, grading, collected, console, adjusting.deadline, class_request.publish)
                except KeyboardInterrupt:
                    kept, wanted = len(marking.entries), len(collected.handed_in)
                    text = f"Stopped. {kept} of {wanted} are graded and kept. Run the same command to continue."
                    console.print(text)
                    return STOPPED


def _adjusting(exercise: Exercise, class_request: ClassRequest, students: set[str]) -> Adjusting:
    overrides = overrides_in(class_request.overrides, students) if class_request.overrides else {}
    for student in class_request.regrade:
        if student not in (*students, "*"):
            raise SubmissionsError(f'--regrade {student}: no submission from a student called "{student}".')
    return Adjusting(deadline_of(exercise), overrides)


def _grade(marking: ClassGrading, plan: Plan, submissions: Mapping[str, Submission], console: Console) -> None:
    if plan.unchanged:
        console.print(f"{len(plan.unchanged)} unchanged since they were graded.")
    if not plan.to_grade:
        return
    with ProgressDisplay(console, len(plan.to_grade)) as progress:
        for entry in marking.run(plan, submissions):
            former = plan.former.get(entry.student.id)
            progress.done(entry, difference(former.grade, entry.grade) if former else "")


def _may_replace(class_request: ClassRequest, console: Console, count: int) -> bool:
    """Ask the instructor, if there is a terminal to ask in."""
    if class_request.replace or not sys.stdin.isatty():
        if not class_request.replace:
            console.print("To replace them: the same command with --yes.")
        return class_request.replace
    return Confirm.ask(f"Replace {count} grades?", console=console, default=False)


def _finish(
    marking: ClassGrading,
    grading: Grading,
    collected: Submissions,
    console: Console,
    deadline: Deadline | None,
    publishes: bool,
) -> int:
    every = [_writable(entry, marking, deadline) for _, entry in sorted(marking.entries.items())]
    faults = [entry for entry in every if entry.final is None]
    entries = [entry for entry in every if entry.final is not None]
    folder = marking.results.folder
    write_gradebook(folder, marking.exercise, entries, deadline.due if deadline else None)
    asked = [Skipped(", ".join(question.files), str(question)) for question in collected.questions]
    misconceptions = grouped(entries, _signatures(grading, entries, console))
    skipped = [*asked, *collected.skipped]
    write_if_changed(
        folder / "index.html", overview_page(marking.exercise, entries, skipped, faults, misconceptions), durable=True
    )
    others = marking.results.others({entry.student.id for entry in every})
    if others:
        console.print(f"from an earlier run, unchanged: {', '.join(others)}", style="yellow")
    show_result(console, entries, faults, collected.questions)
    if publishes:
        console.print(f"One zip per student: {publish(folder, entries)}", soft_wrap=True, markup=False)
    console.print(f"Open {folder / 'index.html'}.", soft_wrap=True, markup=False)
    return FAULTS if faults else QUESTIONS if collected.questions else DONE


def _read(collected: Submissions, exercise: Exercise) -> tuple[dict[str, Submission], list[tuple[HandedIn, str]]]:
    """Read the submissions, by student. A file that its reader can't read is listed separately."""
    submissions, unreadable = {}, []
    for one in collected.handed_in:
        try:
            submissions[one.student.id] = read(str(one.file.path), exercise)
        except Exception as error:
            unreadable.append((one, f"{type(error).__name__}: {error}"))
    return submissions, unreadable


def _unread(grading: Grading, one: HandedIn) -> Grade:
    nothing = Submission(one.file.name, "", grading.runner.exercise.file_name, "", None)
    return host_error(grading.runner, nothing, "it could not be read")


def _writable(entry: Entry, marking: ClassGrading, deadline: Deadline | None) -> Entry:
    """Return the entry, as a `host-error` if the gradebook's files can't hold it: they must not fail for the class."""
    try:
        gradebook(marking.results.folder, marking.exercise, [entry], deadline.due if deadline else None)
    except Exception as error:
        return marking.give_up(entry, not_written(error))
    return entry


def _signatures(grading: Grading, entries: Sequence[Entry], console: Console) -> tuple[Signature, ...]:
    if all(entry.grade.full_marks or entry.grade.outcome != "graded" for entry in entries):
        return ()
    with console.status("grading the common mistakes"):
        return signatures(grading, [failures_of(entry.grade).keys() for entry in entries])


@contextlib.contextmanager
def _backend(grading: Grading, class_request: ClassRequest) -> Iterator[Backend]:
    if class_request.scheduler:
        from grader.classroom.dask import dask_backend

        with dask_backend(grading, class_request.scheduler) as workers:
            yield workers
    else:
        yield LocalBackend(grading, class_request.jobs or at_once(grading.runner.middleware))


@contextlib.contextmanager
def _ended_by_signals() -> Iterator[None]:
    """End a run on SIGTERM, which a machine sends when it shuts down, as cleanly as on Ctrl-C."""

    def stop(number: int, frame: FrameType | None) -> None:
        raise KeyboardInterrupt

    former = signal.signal(signal.SIGTERM, stop)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, former)
