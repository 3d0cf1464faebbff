"""`spinbook grade EXERCISE FOLDER`, from the folder to the gradebook."""

from __future__ import annotations

import contextlib
import signal
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import FrameType

from rich.console import Console
from rich.prompt import Confirm

from grader.classroom import Entry, Skipped
from grader.classroom.writing import write
from grader.crew import Crew
from grader.deadline import Adjusting, Deadline, deadline_of, overrides_in
from grader.exercise import Exercise
from grader.gradebook.files import gradebook, write_gradebook
from grader.grading import Grade, grading_of
from grader.grading.grading import Grading
from grader.intake import HandedIn, Intake, IntakeError, take_in
from grader.marking.difference import difference
from grader.marking.fault import fault
from grader.marking.here import Here, at_once
from grader.marking.marking import Marking, Plan, not_written
from grader.marking.marks import Markers
from grader.marking.order import Order
from grader.marking.progress import Progressing
from grader.marking.publishing import publish
from grader.marking.rejudging import rejudge
from grader.marking.results import Results
from grader.marking.summary import tell_end, tell_intake
from grader.misconception.grouping import grouped
from grader.misconception.known import signatures
from grader.misconception.signature import Signature, failures_of
from grader.overview.page import overview_page
from grader.submission import Submission, read

#: Exit codes, beside click's 2 for usage and a shell's 130 for Ctrl-C.
DONE, QUESTIONS, FAULTS, STOPPED = 0, 1, 3, 130


def grade_class(exercise: Exercise, order: Order, console: Console) -> int:
    """Grade a class, and say how it went; returns the exit code.

    Raises `IntakeError` where there is nothing to grade, `OverridesError` for a mistake in the overrides, `Busy` when
    another run is at work on the same results, and what `grading_of` raises.
    """
    with tempfile.TemporaryDirectory(prefix="spinbook-class-") as unpacked, _ended_by_signals():
        intake = take_in(order.source, exercise.name, Path(unpacked))
        tell_intake(console, intake.kind, len(intake.handed_in), intake.skipped)
        adjusting = _adjusting(exercise, order, {one.student.id for one in intake.handed_in})
        submissions, unreadable = _read(intake, exercise)
        intake = replace(intake, handed_in=tuple(one for one in intake.handed_in if one.student.id in submissions))
        with Results(order.out) as results, Crew(order.options.middleware) as crew:
            grading = grading_of(exercise, order.options, crew)
            with _markers(grading, order) as markers:
                marking = Marking(exercise, markers, results, adjusting, grading)
                if order.rejudge:
                    rejudge(marking, grading, intake, submissions, console, partial(_may_replace, order, console))
                    marking.take_in(intake)
                    return _finish(marking, grading, intake, console, adjusting.deadline, order.publish)
                plan = marking.plan(intake, submissions, lambda who: "*" in order.regrade or who in order.regrade)
                for one, error in unreadable:
                    marking.give_up(Entry(one.student, one.file.name, _unread(grading, one)), f"reading it: {error}")
                try:
                    _grade(marking, plan, submissions, console)
                    return _finish(marking, grading, intake, console, adjusting.deadline, order.publish)
                except KeyboardInterrupt:
                    kept, wanted = len(marking.entries), len(intake.handed_in)
                    told = f"Stopped. {kept} of {wanted} are graded and kept; the same command goes on from there."
                    console.print(told)
                    return STOPPED


def _adjusting(exercise: Exercise, order: Order, students: set[str]) -> Adjusting:
    overrides = overrides_in(order.overrides, students) if order.overrides else {}
    for student in order.regrade:
        if student not in (*students, "*"):
            raise IntakeError(f"--regrade {student}: nobody is called so who handed something in.")
    return Adjusting(deadline_of(exercise), overrides)


def _grade(marking: Marking, plan: Plan, submissions: Mapping[str, Submission], console: Console) -> None:
    if plan.unchanged:
        console.print(f"{len(plan.unchanged)} unchanged since they were graded.")
    if not plan.to_grade:
        return
    with Progressing(console, len(plan.to_grade)) as progress:
        for entry in marking.run(plan, submissions):
            former = plan.former.get(entry.student.id)
            progress.done(entry, difference(former.grade, entry.grade) if former else "")


def _may_replace(order: Order, console: Console, count: int) -> bool:
    """Ask the instructor, where there is a terminal to ask in."""
    if order.replace or not sys.stdin.isatty():
        if not order.replace:
            console.print("To replace them: the same command with --yes.")
        return order.replace
    return Confirm.ask(f"Replace {count} grades?", console=console, default=False)


def _finish(
    marking: Marking, grading: Grading, intake: Intake, console: Console, deadline: Deadline | None, publishes: bool
) -> int:
    every = [_writable(entry, marking, deadline) for _, entry in sorted(marking.entries.items())]
    faults = [entry for entry in every if entry.final is None]
    entries = [entry for entry in every if entry.final is not None]
    folder = marking.results.folder
    write_gradebook(folder, marking.exercise, entries, deadline.due if deadline else None)
    asked = [Skipped(", ".join(question.files), str(question)) for question in intake.questions]
    misconceptions = grouped(entries, _signatures(grading, entries, console))
    skipped = [*asked, *intake.skipped]
    write(folder / "index.html", overview_page(marking.exercise, entries, skipped, faults, misconceptions))
    others = marking.results.others({entry.student.id for entry in every})
    if others:
        console.print(f"of an earlier run, left as they are: {', '.join(others)}", style="yellow")
    tell_end(console, entries, faults, intake.questions)
    if publishes:
        console.print(f"One zip per student: {publish(folder, entries)}", soft_wrap=True, markup=False)
    console.print(f"Open {folder / 'index.html'}.", soft_wrap=True, markup=False)
    return FAULTS if faults else QUESTIONS if intake.questions else DONE


def _read(intake: Intake, exercise: Exercise) -> tuple[dict[str, Submission], list[tuple[HandedIn, str]]]:
    """Read the submissions, by student. A file that breaks its reader is listed apart, and stops nobody else's."""
    submissions, unreadable = {}, []
    for one in intake.handed_in:
        try:
            submissions[one.student.id] = read(str(one.file.path), exercise)
        except Exception as error:
            unreadable.append((one, f"{type(error).__name__}: {error}"))
    return submissions, unreadable


def _unread(grading: Grading, one: HandedIn) -> Grade:
    nothing = Submission(one.file.name, "", grading.spinner.exercise.file_name, "", None)
    return fault(grading.spinner, nothing, "it could not be read")


def _writable(entry: Entry, marking: Marking, deadline: Deadline | None) -> Entry:
    """Return the entry, as a `host-error` if the gradebook's files can't hold it: they must not fail for the class."""
    try:
        gradebook(marking.results.folder, marking.exercise, [entry], deadline.due if deadline else None)
    except Exception as error:
        return marking.give_up(entry, not_written(error))
    return entry


def _signatures(grading: Grading, entries: Sequence[Entry], console: Console) -> tuple[Signature, ...]:
    if all(entry.grade.full_marks or entry.grade.outcome != "graded" for entry in entries):
        return ()
    with console.status("finding out how the usual mistakes fail"):
        return signatures(grading, [failures_of(entry.grade).keys() for entry in entries])


@contextlib.contextmanager
def _markers(grading: Grading, order: Order) -> Iterator[Markers]:
    if order.scheduler:
        from grader.marking.cluster import cluster

        with cluster(grading, order.scheduler) as workers:
            yield workers
    else:
        yield Here(grading, order.jobs or at_once(grading.spinner.middleware))


@contextlib.contextmanager
def _ended_by_signals() -> Iterator[None]:
    """SIGTERM, which a machine sends that shuts down, ends a run as cleanly as Ctrl-C."""

    def stop(number: int, frame: FrameType | None) -> None:
        raise KeyboardInterrupt

    former = signal.signal(signal.SIGTERM, stop)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, former)
