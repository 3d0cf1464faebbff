"""The results of a class: the folder that stores them, and what has to be graded again."""

from __future__ import annotations

import contextlib
import errno
import gzip
import hashlib
import json
import os
import tempfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any

from grader.classroom.deadline import Adjuster
from grader.classroom.request import Backend, GradedSubmission
from grader.classroom.submissions import StudentSubmission, Submissions
from grader.exercise.data_files import data_paths
from grader.exercise.exercise import Exercise
from grader.grading.grade import Entry, Grade, Student
from grader.grading.grading import Grading
from grader.grading.reference import digest_of, exercise_digest, versions
from grader.recording.recording import Recording
from grader.recording.recording import from_json as recordings_from_json
from grader.recording.recording import to_json as recordings_to_json
from grader.report.as_json import STUDENTS, folder_of, read_grade, to_json
from grader.report.feedback import feedback_page
from grader.submission.submission import Submission
from groundwork.files import read_kept, remove_parts, try_lock, write_if_changed

#: The recordings in a student's folder: a line with their key and the name of the file, next to `students/`, with the
#: solution's recordings; then JSON.
RECORDINGS = "recordings.json.gz"
REFERENCE = "reference-{}.json.gz"

#: After one of these, no other student's results can be written either.
NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EROFS)


class NotWritable(Exception):
    """Raised if the results can't be written; the text tells the instructor why."""

    def __init__(self, folder: Path, error: OSError) -> None:
        why = error.strerror or str(error)
        super().__init__(f"{error.filename or folder}: the results can't be written: {why}.")


class FolderInUse(Exception):
    """Raised if another grading is writing to the folder, or if it holds the grades of another exercise."""


class Results:
    """One folder of results. Use it as a context manager, which keeps other gradings from writing to it."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._lock = -1
        self._reference: tuple[dict[str, Recording], str] = ({}, "")

    def entry(self, student: str) -> tuple[Entry, str] | None:
        """Return a student's stored entry and the key of the grade; None if missing or unreadable."""
        return read_grade(folder_of(self.folder, student) / "grade.json")

    def check_exercise(self, exercise: str) -> None:
        """Raise `FolderInUse` if the folder has grades of another exercise than this one."""
        for file in sorted(self.folder.glob(f"{STUDENTS}/*/grade.json")):
            stored = self.entry(file.parent.name)
            if stored and stored[0].grade.exercise != exercise:
                raise FolderInUse(
                    f"{self.folder} holds the grades of the exercise {stored[0].grade.exercise}, which those of "
                    f"{exercise} would replace. Give each exercise a folder of its own with --out."
                )

    def plot(self, student: str) -> str | None:
        """Return the stored plot of a student's run."""
        return read_kept(folder_of(self.folder, student) / "plot.svg", bytes.decode)

    def stored(self, student: str) -> StoredRun | None:
        """Return the stored recordings of a student's run; None if there are none."""
        stored = read_kept(folder_of(self.folder, student) / RECORDINGS, _recordings_in)
        if stored is None:
            return None
        key, _, reference = stored[0].partition(" ")
        references = read_kept(self.folder / Path(reference).name, _recordings_in)
        return StoredRun(key, stored[1], references[1] if references else {})

    def keep_recordings(self, student: str, key: str, grade: Grade) -> None:
        """Store the recordings of a student's run, for changed checks and for questions about the grade."""
        if grade.references is not self._reference[0]:
            name = REFERENCE.format(hashlib.sha256(recordings_to_json(grade.references).encode()).hexdigest()[:12])
            self._write_recordings(self.folder / name, "", grade.references)
            self._reference = (grade.references, name)
        first = f"{key} {self._reference[1]}"
        self._write_recordings(folder_of(self.folder, student) / RECORDINGS, first, grade.recordings)

    def _write_recordings(self, file: Path, first: str, recordings: dict[str, Recording]) -> None:
        text = f"{first}\n{recordings_to_json(recordings)}"
        content = gzip.compress(text.encode(), compresslevel=3, mtime=0)  # a third of 6's time, a third larger
        write_if_changed(file, content, durable=True)

    def write(self, entry: Entry, key: str, page: str, plot: str | None) -> None:
        """Store a student's entry. If this is interrupted, the next run grades the submission again."""
        folder = folder_of(self.folder, entry.student.id)
        text = to_json(entry, key)
        try:
            if (folder / "grade.json").read_text(encoding="utf-8") != text:
                # It confirms the files that are about to change.
                (folder / "grade.json").unlink()
        except (OSError, ValueError):
            pass
        write_if_changed(folder / "feedback.html", page, durable=True)
        if plot is not None:
            write_if_changed(folder / "plot.svg", plot, durable=True)
        else:
            (folder / "plot.svg").unlink(missing_ok=True)
        write_if_changed(folder / "grade.json", text, durable=True)

    def forget(self, student: str) -> None:
        """Remove the key that confirms a student's results, so the next run grades the submission again."""
        with contextlib.suppress(OSError):
            (folder_of(self.folder, student) / "grade.json").unlink(missing_ok=True)

    def others(self, students: set[str]) -> tuple[str, ...]:
        """Return the ids of students with results here who are not in `students`."""
        stored = {file.parent.name for file in self.folder.glob(f"{STUDENTS}/*/grade.json")}
        return tuple(sorted(stored - students))

    def __enter__(self) -> Results:
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=self.folder):  # a lock would also succeed in a read-only folder
                pass
            lock = try_lock(self.folder / ".lock")
        except FileExistsError as error:
            raise NotWritable(self.folder, NotADirectoryError(errno.ENOTDIR, "Not a folder", error.filename)) from None
        except OSError as error:
            raise NotWritable(self.folder, error) from None
        if lock is None:
            raise FolderInUse(f"{self.folder}: another grading is writing to this folder. Wait until it has finished.")
        self._lock = lock
        for folder in (self.folder, *self.folder.glob(f"{STUDENTS}/*/")):
            remove_parts(folder)
        return self

    def __exit__(self, *error: object) -> None:
        os.close(self._lock)


@dataclass(frozen=True)
class StoredRun:
    """The recordings of a student's run and of the solution's, by scenario; `key` is what they depend on."""

    key: str
    recordings: dict[str, Recording]
    references: dict[str, Recording]


def _recordings_in(content: bytes) -> tuple[str, dict[str, Recording]]:
    first, _, text = gzip.decompress(content).decode().partition("\n")
    return first, recordings_from_json(text)


def grade_key(grading: Grading) -> str:
    """Return a key that is equal for two gradings that give every submission the same grade.

    It covers the parts of the exercise that grades and pages show, the machine's versions of Python and ROS, and the
    level of isolation.
    """
    exercise = grading.runner.exercise
    files = [exercise.folder / "task.md", *filter(None, [exercise.solution_file])]
    depends = {
        "exercise": exercise_digest(exercise),
        "files": digest_of([file for file in files if file.exists()]),
        **_of_a_run(grading),
    }
    return _digest(depends)


def recordings_key(grading: Grading, submission: Submission) -> str:
    """Return a key of everything that a submission's recordings depend on; checks are not part of it."""
    return submission_key(_digest(_of_a_run(grading)), submission.digest)


def _of_a_run(grading: Grading) -> dict[str, Any]:
    """Return what a recording depends on, besides the submission."""
    runner = grading.runner
    return {
        "scenarios": [scenario.digest for scenario in runner.scenarios],
        "versions": versions(),
        "data": digest_of(data_paths(runner.exercise), runner.exercise.folder),
        "seed": runner.options.seed,
        "pace": runner.options.pace,
        "limits": asdict(runner.options.limits),
        "isolation": str(runner.isolation),
    }


def _digest(depends: dict[str, Any]) -> str:
    return hashlib.sha256(json.dumps(depends, sort_keys=True).encode()).hexdigest()


def submission_key(key: str, digest: str) -> str:
    """Return the key of one submission's grade."""
    return hashlib.sha256(f"{key} {digest}".encode()).hexdigest()


#: A student's attempts that may count, usually one.
Tries = tuple[Submission, ...]


@dataclass(frozen=True)
class ClassPlan:
    """What a run will do. `former` has the entries of an earlier run, by student."""

    to_grade: tuple[StudentSubmission, ...]
    unchanged: tuple[Entry, ...]
    former: Mapping[str, Entry]


@dataclass
class ClassGrading:
    """Grades one class with `backend` into one folder of results."""

    exercise: Exercise
    backend: Backend
    results: Results
    adjust: Adjuster
    grading: Grading | None = None
    """Set if recordings are to be stored."""
    entries: dict[str, Entry] = field(default_factory=dict)

    def plan(
        self, collected: Submissions, submissions: Mapping[str, Tries], regrade: Callable[[str], bool]
    ) -> ClassPlan:
        """Return what has to be graded: submissions that are new, that have changed, or that `regrade` selects.

        `submissions` are those of `collected` after reading, by student.
        """
        to_grade, unchanged, former = [], [], {}
        for handed_in in collected.handed_in:
            who = handed_in.student.id
            kept = self.results.entry(who)
            if kept:
                former[who] = kept[0]
            if kept and kept[1] == self._key(submissions[who]) and not regrade(who):
                store = partial(self._unchanged, handed_in, *kept)
                unchanged.append(self._stored(Entry(handed_in.student, handed_in.file.name, kept[0].grade), store))
            else:
                to_grade.append(handed_in)
        return ClassPlan(tuple(to_grade), tuple(unchanged), former)

    def take_in(self, collected: Submissions) -> None:
        """Use the stored entries of these students unless there are newer ones."""
        for one in collected.handed_in:
            kept = self.results.entry(one.student.id)
            if kept and one.student.id not in self.entries:
                self.entries[one.student.id] = kept[0]

    def run(self, plan: ClassPlan, submissions: Mapping[str, Tries]) -> Iterator[Entry]:
        """Grade what the plan names, and yield each entry once it is stored.

        What several students handed in together is graded once. After a fault of ours or the machine's, the submission
        is tried once more after all others. If that fails, too, the entry says so and has no score, and the next run
        grades it again.
        """
        jobs = {
            str(file.path): submission
            for one in plan.to_grade
            for file, submission in zip(one.files, submissions[one.student.id], strict=True)
        }
        waiting = {one.student.id: one for one in plan.to_grade}
        done: dict[str, GradedSubmission] = {}
        again: dict[str, Submission] = {}
        for last_try in (False, True):
            for graded in self.backend.grade(again if last_try else jobs):
                if graded.grade.outcome == "host-error" and not last_try:
                    again[graded.who] = jobs[graded.who]
                    continue
                done[graded.who] = graded
                yield from self._complete(waiting, done, submissions)

    def _complete(
        self, waiting: dict[str, StudentSubmission], done: dict[str, GradedSubmission], submissions: Mapping[str, Tries]
    ) -> Iterator[Entry]:
        """Store and yield the entries of students whose attempts are all graded; drop grades no longer needed."""
        ready = [each for each in waiting.values() if all(str(file.path) in done for file in each.files)]
        for handed_in in ready:
            del waiting[handed_in.student.id]
            graded = self._best(handed_in, [done[str(file.path)] for file in handed_in.files])
            store = partial(self.keep, handed_in, graded, submissions[handed_in.student.id])
            yield self._stored(Entry(handed_in.student, handed_in.file.name, graded.grade), store)
        needed = {str(file.path) for handed_in in waiting.values() for file in handed_in.files}
        for path in done.keys() - needed:
            del done[path]

    def _best(self, handed_in: StudentSubmission, attempts: list[GradedSubmission]) -> GradedSubmission:
        """Return the attempt with the most points, late or not. After a fault of ours the best attempt is not known."""
        if faults := [graded for graded in attempts if not graded.grade.has_score]:
            return faults[0]
        finals = []
        for file, graded in zip(handed_in.files, attempts, strict=True):
            entry = _of_file(Entry(handed_in.student, file.name, graded.grade), handed_in)
            finals.append(replace(entry, adjustments=self.adjust(entry)).final or 0.0)
        best = finals.index(max(finals))
        name = handed_in.files[best].name
        return replace(attempts[best], grade=replace(attempts[best].grade, submission=name))

    def _stored(self, entry: Entry, store: Callable[[], Entry]) -> Entry:
        """Store an entry. If its page or files can't be written, it becomes a `host-error`, and the others go on."""
        try:
            return store()
        except Exception as error:
            stop_if_no_room(self.results.folder, error)
            return self.give_up(entry, not_written(error))

    def record(self, student: Student, grade: Grade) -> Entry:
        """Store the entry of a student without a submission to grade."""
        entry = Entry(student, "", grade)
        self.entries[student.id] = entry = replace(entry, adjustments=self.adjust(entry))

        def store() -> Entry:
            self.results.write(entry, "", feedback_page(entry, self.exercise, None), None)
            return entry

        return self._stored(entry, store)

    def give_up(self, entry: Entry, what: str) -> Entry:
        """Turn an entry into a `host-error` that says `what` happened; the next run tries it again."""
        message = f"This is not your fault: {what}"
        grade = replace(
            entry.grade, outcome="host-error", message=message, score=0.0, verdicts=(), recordings={}, references={}
        )
        self.entries[entry.student.id] = entry = replace(entry, grade=grade, adjustments=(), submitted=None)
        self.results.forget(entry.student.id)
        return entry

    def keep(self, handed_in: StudentSubmission, graded: GradedSubmission, tries: Tries) -> Entry:
        """Write a grade with its page into the student's folder."""
        submission = next((one for one in tries if one.digest == graded.grade.digest), tries[0])
        entry = self._entry(handed_in, Entry(handed_in.student, graded.grade.submission, graded.grade))
        grade = entry.grade
        key = self._key(tries) if grade.has_score else ""
        if grade.recordings and self.grading:
            recorded = recordings_key(self.grading, submission)
            self.results.keep_recordings(entry.student.id, recorded, grade)
        self.results.write(entry, key, feedback_page(entry, self.exercise, graded.plot), graded.plot)
        # The page contains the recordings now; those of a whole class would fill the memory.
        self.entries[entry.student.id] = entry = replace(entry, grade=replace(grade, recordings={}, references={}))
        return entry

    def _unchanged(self, handed_in: StudentSubmission, kept: Entry, key: str) -> Entry:
        """Return the entry of a submission that needs no grading, with the student's current name and date."""
        entry = self._entry(handed_in, kept)
        plot = self.results.plot(entry.student.id)
        self.results.write(entry, key, feedback_page(entry, self.exercise, plot), plot)
        return entry

    def _entry(self, handed_in: StudentSubmission, of: Entry) -> Entry:
        entry = _of_file(of, handed_in)
        entry = replace(entry, adjustments=self.adjust(entry))
        self.entries[entry.student.id] = entry
        return entry

    def _key(self, tries: Tries) -> str:
        return submission_key(
            self.backend.key, " ".join(sorted(f"{one.digest} {one.warning} {one.notes}" for one in tries))
        )


def _of_file(of: Entry, handed_in: StudentSubmission) -> Entry:
    """Return the entry with the student's name and the file's date as they are now.

    Of several attempts, the name tells which one the entry is for.
    """
    file = next((file for file in handed_in.files if file.name == of.file), handed_in.file)
    return replace(
        of,
        student=handed_in.student,
        file=file.name,
        grade=replace(of.grade, submission=file.name),
        submitted=file.submitted,
        submitted_from=file.submitted_from if file.submitted else "",
        adjustments=(),
    )


def stop_if_no_room(folder: Path, error: Exception) -> None:
    """Raise `NotWritable` if nothing else can be written either after this error."""
    if isinstance(error, OSError) and error.errno in NO_ROOM:
        raise NotWritable(folder, error) from None


def not_written(error: Exception) -> str:
    """Return a sentence that says that a student's results could not be written."""
    return f"the results could not be written: {type(error).__name__}: {error}"
