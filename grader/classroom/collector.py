"""Finds out who submitted what, from a folder, a zip, a learning platform's download or a CSV file."""

from __future__ import annotations

import os
import shutil
from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import tzinfo
from pathlib import Path

from grader.classroom.archive import unpacked, walk
from grader.classroom.class_table import by_row
from grader.classroom.formats.format import Export, UploadedFile
from grader.classroom.formats.per_student import without_suffix
from grader.classroom.formats.registry import PLAIN
from grader.classroom.groups import Attempt, Group, Unit, in_groups
from grader.classroom.names import may_be_one, normal, same_but_for_numbers, unique_ids
from grader.classroom.recogniser import GRADABLE, Recogniser, Recognition, can_be_graded
from grader.classroom.roster import RosterRow, match, signs, with_row
from grader.classroom.submissions import File, Question, StudentSubmission, Submissions, SubmissionsError
from grader.exercise.exercise import Exercise
from grader.grading.grade import SkippedFile, Student
from grader.submission.file_kinds import can_be_read, kind_of, kind_of_content
from groundwork.words import counted

KINDS = "not one of .py, .ipynb, .zip"


@dataclass(frozen=True)
class CollectOptions:
    """The instructor's options for reading a class: see `spinbook grade`.

    `attempts` is "last", "first" or "best"; if it is empty, several attempts are a question. `zone` is the time zone of
    times that have none; None is this machine's.
    """

    format: str = ""
    attempts: str | None = None
    zone: tzinfo | None = None
    roster: tuple[RosterRow, ...] = ()
    groups: tuple[Group, ...] = ()


def collect(source: Path, exercise: Exercise, unpack_into: Path, options: CollectOptions | None = None) -> Submissions:
    """Return what the class submitted. The names of the files decide how a folder or a zip is read.

    A zip's files are written into the folder `unpack_into`, which has to be empty. Raises `SubmissionsError` if
    there is nothing to grade, or if it is not clear how to read the source.
    """
    options = options or CollectOptions()
    if not source.exists():
        raise SubmissionsError(f"{source}: there is no such file or folder.")
    if source.suffix.lower() == ".csv":
        uploads, skipped, absent = by_row(source, options.zone)
        found = ClassFiles(f"the files that {source.name} names", uploads, skipped, absent, together=False)
    else:
        found = _found(source, exercise, unpack_into, options)
    if not any(can_be_read(file.name) or _has_work(file.path) for file, _ in found.uploads):
        left_out = [*(str(one) for one in found.odd), *(f"{skip.file}: {skip.why}" for skip in found.skipped)]
        raise SubmissionsError("\n  ".join(["There is no submission in it.", *left_out[:10]]))
    return Collector(unpack_into, options, found.together).submissions(found)


@dataclass(frozen=True)
class ClassFiles:
    """The files of a class: those whose owners are known, and the others; see `Submissions`.

    With `together`, all files of an attempt are one submission, such as a package.
    """

    kind: str
    uploads: Sequence[tuple[File, UploadedFile]]
    skipped: Sequence[SkippedFile]
    odd: Sequence[Question] = ()
    dates: str = ""
    together: bool = True


def _found(source: Path, exercise: Exercise, unpack_into: Path, options: CollectOptions) -> ClassFiles:
    everything = list(walk(source) if source.is_dir() else unpacked(source, unpack_into))
    files = {tuple(one.name.split("/")): one for one in everything if isinstance(one, File)}
    left_out = [one for one in everything if isinstance(one, SkippedFile)]
    if not files:
        return ClassFiles("", (), left_out)
    root = source.resolve().name if source.is_dir() else without_suffix(source.name)
    recognition = Recogniser(Export(files, root, exercise, options.zone)).recognise(options.format)
    if not source.is_dir() and len(files) == 1 and recognition.form is PLAIN:
        _refuse_class_within(source.name, next(iter(files.values())), exercise, unpack_into / "within")
    folder = f", in {'/'.join(recognition.inside)}/" if recognition.inside else ""
    uploads = [(file, place) for file, place in recognition.understood if isinstance(place, UploadedFile)]
    others = [
        SkippedFile(file.name, place) for file, place in recognition.understood if isinstance(place, str) and place
    ]
    others += [SkippedFile(file.name, f"not in {'/'.join(recognition.inside)}/") for file in recognition.others]
    why = f"its name is not one of {recognition.form.title}"
    if recognition.form is PLAIN:
        why = "it is named after the exercise, not after a student"
    others += [SkippedFile(file.name, why) for _, file in recognition.misfits if not can_be_graded(file.name)]
    return ClassFiles(
        recognition.form.title + folder, uploads, [*left_out, *others], _odd(recognition, why), recognition.form.dates
    )


def _refuse_class_within(around: str, only: File, exercise: Exercise, unpack_into: Path) -> None:
    """Raise `SubmissionsError` if `only`, an archive that is all another one holds, seems to be a whole class."""
    if kind_of(only.name) != "archive":
        return
    unpack_into.mkdir()
    try:
        inner = {tuple(one.name.split("/")): one for one in unpacked(only.path, unpack_into) if isinstance(one, File)}
        recognition = Recogniser(Export(inner, without_suffix(only.name), exercise, None)).recognise()
    except SubmissionsError:
        return  # one student's, then, who gets a row that says what is wrong with it
    if len(recognition.fits) > 1:
        raise SubmissionsError(
            f"{around} holds nothing but {only.name}, in which are {len(recognition.fits)} submissions "
            f"({recognition.form.title}).\nUnpack {around}. Then grade {only.name} if it is a class, or the "
            "folder that it is in if it is one student's work."
        )


def _odd(recognition: Recognition, why: str) -> list[Question]:
    """Return a question for each gradable file or folder whose name does not fit the platform's format."""
    files: dict[str, list[str]] = defaultdict(list)
    for top, file in recognition.misfits:
        if can_be_graded(file.name):
            files[top].append(file.name)
    return [Question(Student(without_suffix(top)), tuple(names), "name", why) for top, names in files.items()]


@dataclass(frozen=True)
class Collector:
    """Turns files whose owners are known into one submission per student."""

    folder: Path
    options: CollectOptions
    together: bool

    def submissions(self, found: ClassFiles) -> Submissions:
        """Return one submission per student. Anything unclear becomes a question, never a guess."""
        units = in_groups(_units(found.uploads), self.options.groups)
        extras: list[SkippedFile] = []
        theirs: dict[str, list[StudentSubmission | Question]] = defaultdict(list)
        for number, unit in enumerate(units):
            for one in self._chosen(unit, number, extras):
                theirs[normal(one.student.id)].append(one)
        chosen = [_only(several) for several in theirs.values()]
        chosen += [question for question in found.odd if normal(question.student.id) not in theirs]
        rows = match(self.options.roster, [one.student for one in chosen])
        strangers = [one.student for one in chosen if one.student.id not in rows] if self.options.roster else []
        unlisted = [f"not on the roster: {', '.join(one.id for one in strangers)}"] if strangers else []
        missing = self._missing([one.student for one in chosen], rows)
        missing = [student for student in missing if normal(student.id) not in theirs]
        ids = unique_ids([*(one.student.id for one in chosen), *(student.id for student in missing)])
        named = [_named(one, rows.get(one.student.id), ids) for one in chosen]
        handed_in = sorted((one for one in named if isinstance(one, StudentSubmission)), key=lambda one: one.student.id)
        questions = sorted((one for one in named if isinstance(one, Question)), key=lambda one: one.student.id)
        return Submissions(
            found.kind,
            tuple(handed_in),
            tuple(sorted((*found.skipped, *extras), key=lambda one: one.file)),
            tuple(questions),
            tuple(replace(student, id=ids[normal(student.id)]) for student in missing),
            (*_notes(handed_in), *_not_gradable(handed_in), *unlisted, *self._ungrouped(units), *self._alike(ids)),
            found.dates,
            {ids[normal(who)]: text for who, text in _mismatches(strangers, missing, bool(rows))},
        )

    def _chosen(self, unit: Unit, number: int, extras: list[SkippedFile]) -> list[StudentSubmission | Question]:
        """Return the submission of each student in the unit, with the attempts that the options select."""
        attempts = [unit.attempts[key] for key in sorted(unit.attempts)]
        if len(attempts) > 1 and not self.options.attempts:
            names = tuple(attempt[0][0].name for attempt in attempts)
            return [Question(student, names, "attempts") for student in unit.students]
        if self.options.attempts == "first":
            attempts = attempts[:1]
        elif self.options.attempts == "last":
            attempts = attempts[-1:]
        files = []
        for nth, attempt in enumerate(reversed(attempts)):
            file = self._submission(attempt, f"{number}-{nth}", extras)
            if file is None:
                return [Question(student, tuple(one.name for one, _ in attempt)) for student in unit.students]
            if file.fault:
                return [Question(student, (file.name,), "damaged", file.fault) for student in unit.students]
            files.append(file)
        return [StudentSubmission(student, files[0], tuple(files[1:])) for student in unit.students]

    def _submission(self, attempt: Attempt, name: str, extras: list[SkippedFile]) -> File | None:
        """Return the file of an attempt, or the folder of its files; None if it is not clear which file counts."""
        several = [file for file, _ in attempt if can_be_graded(file.name)]
        if len(attempt) > 1 and len(several) != 1:
            return self._folder(attempt, name) if self.together else None
        chosen = several[0] if several else attempt[0][0]
        extras += [SkippedFile(file.name, KINDS) for file, _ in attempt if several and file is not chosen]
        return replace(chosen, time=next(upload.time for file, upload in attempt if file is chosen))

    def _folder(self, attempt: Attempt, name: str) -> File:
        """Return a new folder with the attempt's files, under the names that the student gave them."""
        folder = self.folder / f"submission-{name}"
        for file, upload in attempt:
            if file.path.is_symlink() or file.fault:
                continue
            to = folder.joinpath(*(os.fsdecode(os.fsencode(part)[:200]) for part in upload.inside))
            to = to if not to.exists() else to.with_name(f"{file.path.stem}_{to.name}")
            to.parent.mkdir(parents=True, exist_ok=True)
            try:
                os.link(file.path, to)
            except OSError:
                shutil.copyfile(file.path, to)
        first, upload = attempt[0]
        parts = first.name.split("/")
        name = "/".join(parts[: len(parts) - len(upload.inside)]) or first.name
        return File(name, folder, upload.time, next((file.fault for file, _ in attempt if file.fault), ""))

    def _missing(self, students: Sequence[Student], rows: dict[str, RosterRow]) -> list[Student]:
        """Return the students of the roster and of the groups who submitted nothing."""
        there = {id(row) for row in rows.values()}
        missing = [row.student for row in self.options.roster if id(row) not in there]
        listed = [row.student for row in self.options.roster]
        known = {sign for student in (*students, *listed) for sign in signs(student)}
        members = [member for group in self.options.groups for member in group.members]
        missing += [member for member in members if not signs(member) & known]
        return missing

    def _ungrouped(self, units: Sequence[Unit]) -> Iterator[str]:
        """Yield a note on those who handed in and are in none of the groups."""
        members = {sign for group in self.options.groups for member in group.members for sign in signs(member)}
        alone = [one.id for unit in units for one in unit.students if not signs(one) & members]
        if members and alone:
            yield f"in no group of --groups: {', '.join(alone)}"

    def _alike(self, names: Iterable[str]) -> Iterator[str]:
        """Yield a note on names that may be one student's, if no roster says who is who."""
        for same in () if self.options.roster else same_but_for_numbers(names):
            yield f"counted as {len(same)} students: {', '.join(same)}. Rename the files if they are one student's"


def _mismatches(
    strangers: Sequence[Student], missing: Sequence[Student], some_match: bool
) -> Iterator[tuple[str, str]]:
    """Yield the id of each student whom the roster may name otherwise than the files do, and what suggests it."""
    if strangers and missing and not some_match:
        text = f"they have no name in common: {missing[0].id} is on the roster, {strangers[0].id} handed in"
        yield from ((listed.id, text) for listed in missing)
        return
    for listed in missing:
        alike = [one.id for one in strangers if _may_be(one, listed)]
        known = f"{listed.id} ({listed.name})" if listed.name else listed.id
        if alike:
            yield listed.id, f"{known} is on the roster, {', '.join(alike)} handed in"


def _may_be(one: Student, listed: Student) -> bool:
    return any(may_be_one(name, other) for name in (one.id, one.name) for other in (listed.id, listed.name))


def _units(uploads: Sequence[tuple[File, UploadedFile]]) -> list[Unit]:
    """Return what each student or group handed in; files marked `aside` only if there is nothing else."""
    by_owner: dict[tuple[str, ...], list[tuple[File, UploadedFile]]] = defaultdict(list)
    for file, upload in uploads:
        by_owner[tuple(student.id for student in upload.students)].append((file, upload))
    units = []
    for theirs in by_owner.values():
        attempts: dict[str, list[tuple[File, UploadedFile]]] = defaultdict(list)
        for file, upload in [one for one in theirs if not one[1].aside] or theirs[:1]:
            attempts[upload.attempt].append((file, upload))
        units.append(Unit(theirs[0][1].students, attempts))
    return units


def _only(several: list[StudentSubmission | Question]) -> StudentSubmission | Question:
    """Return a student's submission. One alone and one in a group are a question: which one counts?"""
    if len(several) == 1:
        return several[0]
    names = [one.files if isinstance(one, Question) else (one.file.name,) for one in several]
    return Question(several[0].student, tuple(name for some in names for name in some))


def _named(
    one: StudentSubmission | Question, row: RosterRow | None, ids: dict[str, str]
) -> StudentSubmission | Question:
    student = replace(with_row(one.student, row), id=ids[normal(one.student.id)])
    if isinstance(one, StudentSubmission) and row and row.time.at:
        return StudentSubmission(student, replace(one.file, time=row.time), one.others)
    return replace(one, student=student)


def _not_gradable(handed_in: Sequence[StudentSubmission]) -> list[str]:
    files = [one.file.name for one in handed_in if not can_be_graded(one.file.name) and not _has_work(one.file.path)]
    return [f"handed in, but {KINDS}: {', '.join(files)}"] if files else []


def _has_work(path: Path) -> bool:
    """Return whether this is a folder, or a file whose content is a program though its name does not say so."""
    if not path.is_file() or path.is_symlink():
        return path.is_dir()
    return kind_of_content(path.read_bytes(), "other") in GRADABLE


def _notes(handed_in: Sequence[StudentSubmission]) -> list[str]:
    """Return notes on how ambiguous times were read, and for how many students."""
    count: dict[str, int] = defaultdict(int)
    for one in handed_in:
        if one.file.time.note:
            count[f"{one.file.time.source}: {one.file.time.note}"] += 1
    return [f"{note}, for {counted(number, 'student')}" for note, number in count.items()]
