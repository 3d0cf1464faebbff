"""Grades a class, from the folder of submissions to the gradebook, and shows the progress."""

from __future__ import annotations

import contextlib
import signal
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from datetime import datetime
from functools import partial
from pathlib import Path
from types import FrameType

from rich.console import Console
from rich.prompt import Confirm

from grader.classroom.class_display import ProgressDisplay, say, show_result, show_submissions
from grader.classroom.collector import CollectOptions, collect
from grader.classroom.deadline import Adjuster, Deadline, deadline_of, overrides_in
from grader.classroom.decisions import decisions, show_decisions
from grader.classroom.gradebook import gradebook, write_gradebook
from grader.classroom.groups import read_groups
from grader.classroom.local import LocalBackend, at_once
from grader.classroom.misconceptions import Signature, grouped
from grader.classroom.overview import overview_page
from grader.classroom.rejudge import difference, rejudge
from grader.classroom.request import Backend, ClassRequest, ClusterLost, NoCluster, no_grade
from grader.classroom.results import ClassGrading, ClassPlan, NotWritable, Results, Tries, not_written
from grader.classroom.roster import read_roster
from grader.classroom.signatures import signatures
from grader.classroom.student_zips import publish
from grader.classroom.submissions import StudentSubmission, Submissions, SubmissionsError
from grader.exercise.exercise import Exercise
from grader.grading.grade import Entry, Outcome
from grader.grading.grading import Grading, grading_of
from grader.submission.reader import read
from grader.workers.pool import WorkerPool
from groundwork.files import write_if_changed

#: Exit codes, besides click's 2 for usage and a shell's 130 for Ctrl-C.
DONE, QUESTIONS, FAULTS, STOPPED = 0, 1, 3, 130


def grade_class(exercise: Exercise, class_request: ClassRequest, console: Console) -> int:
    """Grade a class and print the result; return the exit code.

    Raises `SubmissionsError` if there is nothing to grade, or for a mistake in a table, `FolderInUse` if the results
    folder is another run's or another exercise's, `NotWritable` if it can't be written, and what `grading_of` raises.
    """
    with tempfile.TemporaryDirectory(prefix="spinbook-class-") as unpacked, _ended_by_signals():
        deadline = deadline_of(exercise)
        collected = collect(class_request.source, exercise, Path(unpacked), _collect_options(class_request, deadline))
        show_submissions(console, collected)
        adjuster = _adjuster(class_request, deadline, {student.id for student in collected.students})
        collected = adjuster.without_dates_of_a_copy(collected)
        if deadline:
            say(console, f"Deadline: {deadline}.")
        submissions, unreadable = _read(collected, exercise)
        to_decide = decisions(collected, adjuster, submissions)
        show_decisions(console, to_decide, class_request.skip)
        if to_decide and not class_request.skip:
            return QUESTIONS
        collected = replace(
            collected, handed_in=tuple(each for each in collected.handed_in if each.student.id in submissions)
        )
        with Results(class_request.out) as results, WorkerPool(Path(unpacked)) as workers:
            results.check_exercise(exercise.name)
            grading = grading_of(exercise, class_request.options, workers)
            with _backend(grading, class_request, partial(say, console)) as backend:
                class_grading = ClassGrading(exercise, backend, results, adjuster, grading)
                for handed_in, error in unreadable:
                    grade = replace(no_grade(grading.runner, "host-error", ""), submission=handed_in.file.name)
                    class_grading.give_up(Entry(handed_in.student, handed_in.file.name, grade), f"reading it: {error}")
                code = _graded(class_grading, grading, collected, submissions, class_request, console)
                return code or (QUESTIONS if to_decide else DONE)


def _collect_options(class_request: ClassRequest, deadline: Deadline | None) -> CollectOptions:
    zone = deadline.zone if deadline else None
    return CollectOptions(
        class_request.format,
        class_request.attempts,
        zone,
        read_roster(class_request.roster, zone) if class_request.roster else (),
        read_groups(class_request.groups) if class_request.groups else (),
    )


def _adjuster(class_request: ClassRequest, deadline: Deadline | None, students: set[str]) -> Adjuster:
    zone = deadline.zone if deadline else None
    overrides = overrides_in(class_request.overrides, students, zone) if class_request.overrides else {}
    for student in () if deadline else (who for who, theirs in overrides.items() if any(one.due for one in theirs)):
        raise SubmissionsError(
            f"{class_request.overrides}: {student} has another due date, but exercise.toml has no [deadline]. Add one, "
            "or remove the row."
        )
    for student in class_request.regrade:
        if student not in (*students, "*"):
            raise SubmissionsError(f'--regrade {student}: no submission from a student called "{student}".')
    return Adjuster(deadline, overrides)


def _graded(
    class_grading: ClassGrading,
    grading: Grading,
    collected: Submissions,
    submissions: Mapping[str, Tries],
    class_request: ClassRequest,
    console: Console,
) -> int:
    """Grade or judge again, and write the class's files; return the exit code."""
    try:
        _record_others(class_grading, grading, collected)
        if class_request.rejudge:
            may_replace = partial(_may_replace, class_request, console)
            rejudge(class_grading, grading, collected, submissions, console, may_replace)
            class_grading.take_in(collected)
        else:
            regrade = class_request.regrade
            plan = class_grading.plan(collected, submissions, lambda who: "*" in regrade or who in regrade)
            _grade(class_grading, plan, submissions, console)
        return _finish(class_grading, grading, collected, console, class_request.publish)
    except KeyboardInterrupt:
        console.print(f"Stopped. {_kept(class_grading, collected)} Run the same command to continue.")
        return STOPPED
    except ClusterLost as error:
        say(console, f"{error} {_kept(class_grading, collected)} Run the same command to continue.", "red")
        return FAULTS
    except NotWritable as error:
        say(console, f"{error} Free some room, or give another folder with --out.", "red")
        say(console, "What was graded is kept. Run the same command to continue.", "red")
        return FAULTS


def _kept(class_grading: ClassGrading, collected: Submissions) -> str:
    """Return how many submissions have a score that is stored and counts; no other entry is a grade."""
    stored = [class_grading.results.entry(who) for who in class_grading.entries]
    kept = {entry.student.id for entry, _ in filter(None, stored) if entry.grade.has_score}
    students = {one.student.id for one in collected.handed_in}
    return f"{len(kept & students)} of {len(students)} are graded and kept."


def _record_others(class_grading: ClassGrading, grading: Grading, collected: Submissions) -> None:
    """Record an entry for each student without a submission to grade."""
    for student in collected.missing:
        asked = collected.mismatches.get(student.id, "")
        outcome: Outcome = "undecided" if asked else "missing"
        class_grading.record(student, no_grade(grading.runner, outcome, asked or "Nothing was handed in."))
    for question in collected.questions:
        class_grading.record(question.student, no_grade(grading.runner, "undecided", str(question)))


def _grade(class_grading: ClassGrading, plan: ClassPlan, submissions: Mapping[str, Tries], console: Console) -> None:
    if plan.unchanged:
        console.print(f"{len(plan.unchanged)} unchanged since they were graded.")
    if not plan.to_grade:
        return
    with ProgressDisplay(console, len(plan.to_grade)) as progress:
        for entry in class_grading.run(plan, submissions):
            former = plan.former.get(entry.student.id)
            progress.done(entry, difference(former.grade, entry.grade) if former else "")


def _may_replace(class_request: ClassRequest, console: Console, count: int) -> bool:
    """Ask the instructor, if there is a terminal to ask on."""
    if class_request.replace or not sys.stdin.isatty():
        if not class_request.replace:
            console.print("To replace them, run the same command with --yes.")
        return class_request.replace
    return Confirm.ask(f"Replace {count} grades?", console=console, default=False)


def _finish(
    class_grading: ClassGrading, grading: Grading, collected: Submissions, console: Console, publishes: bool
) -> int:
    due = class_grading.adjust.deadline.due if class_grading.adjust.deadline else None
    every = [_writable(entry, class_grading, due) for _, entry in sorted(class_grading.entries.items())]
    unscored = [entry for entry in every if entry.final is None]
    entries = [entry for entry in every if entry.final is not None]
    graded = [entry for entry in entries if entry.grade.outcome != "missing"]
    folder = class_grading.results.folder
    misconceptions = grouped(graded, _signatures(grading, graded, console))
    page = overview_page(class_grading.exercise, entries, collected.skipped, unscored, misconceptions)
    try:
        write_gradebook(folder, class_grading.exercise, every, due)
        write_if_changed(folder / "index.html", page, durable=True)
        published = publish(folder, graded) if publishes else None
    except OSError as error:
        raise NotWritable(folder, error) from None
    others = class_grading.results.others({entry.student.id for entry in every})
    if others:
        say(console, f"graded earlier, handed in nothing now, not in the tables: {', '.join(others)}", "yellow")
        say(console, f"  `spinbook gradebook` counts them as long as their folders are in {folder}/students.")
    show_result(console, entries, unscored, collected.kind)
    if published:
        say(console, f"One zip per student: {published}")
    say(console, f"Open {folder / 'index.html'}.")
    if any(entry.grade.outcome == "host-error" for entry in unscored):
        return FAULTS
    return QUESTIONS if unscored else DONE


def _read(collected: Submissions, exercise: Exercise) -> tuple[dict[str, Tries], list[tuple[StudentSubmission, str]]]:
    """Return the submissions by student, and separately those on which the reader itself failed."""
    submissions, unreadable = {}, []
    for one in collected.handed_in:
        try:
            submissions[one.student.id] = tuple(read(str(file.path), exercise) for file in one.files)
        except Exception as error:
            unreadable.append((one, f"{type(error).__name__}: {error}"))
    return submissions, unreadable


def _writable(entry: Entry, class_grading: ClassGrading, due: datetime | None) -> Entry:
    """Return the entry; as a `host-error` if it can't be written, so that the gradebook does not fail for the class."""
    try:
        gradebook(class_grading.results.folder, class_grading.exercise, [entry], due)
    except Exception as error:
        return class_grading.give_up(entry, not_written(error))
    return entry


def _signatures(grading: Grading, entries: Sequence[Entry], console: Console) -> tuple[Signature, ...]:
    if all(entry.grade.full_marks or entry.grade.outcome != "graded" for entry in entries):
        return ()
    with console.status("grading the usual mistakes") as status:
        announce = status.update if console.is_terminal else partial(say, console)
        return signatures(grading, [entry.grade for entry in entries], announce)


@contextlib.contextmanager
def _backend(grading: Grading, class_request: ClassRequest, tell: Callable[[str], None]) -> Iterator[Backend]:
    if class_request.scheduler:
        try:
            from grader.classroom.dask import dask_backend
        except ImportError:
            raise NoCluster("Dask is not installed here: pip install 'spinbook[cluster]'") from None

        with dask_backend(grading, class_request.scheduler, tell) as workers:
            yield workers
    else:
        yield LocalBackend(grading, class_request.jobs or at_once())


@contextlib.contextmanager
def _ended_by_signals() -> Iterator[None]:
    """Treat SIGTERM, which a machine sends when it shuts down, like Ctrl-C."""

    def stop(number: int, frame: FrameType | None) -> None:
        raise KeyboardInterrupt

    former = signal.signal(signal.SIGTERM, stop)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, former)
