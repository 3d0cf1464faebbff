"""From what an instructor has to one file a student."""

from __future__ import annotations

from pathlib import Path

from grader.classroom import Skipped, Student
from grader.intake.archive import unpacked
from grader.intake.canvas import by_user
from grader.intake.folder import by_student, walk
from grader.intake.handed_in import SUFFIXES, File, HandedIn, Intake, IntakeError, Question, Sorted
from grader.intake.mapping import by_row
from grader.intake.moodle import by_participant
from grader.intake.nbgrader import by_assignment


def take_in(source: Path, exercise: str, unpack_into: Path) -> Intake:
    """What the class handed in, from a folder, a zip or a CSV file; as which of them it reads is seen from the names.

    A zip's files are written into the folder `unpack_into`, which has to be empty. Raises `IntakeError` where there is
    nothing to grade at all.
    """
    if not source.exists():
        raise IntakeError(f"{source}: there is no such file or folder.")
    if source.suffix == ".csv":
        return _chosen(by_row(source), ())
    found = list(walk(source) if source.is_dir() else unpacked(source, unpack_into))
    files = [file for file in found if isinstance(file, File)]
    left_out = tuple(skipped for skipped in found if isinstance(skipped, Skipped))
    root = source.resolve().name.removesuffix(".zip")
    return _chosen(
        by_participant(files) or by_assignment(files, root, exercise) or by_user(files) or by_student(files), left_out
    )


def _chosen(files: Sorted, left_out: tuple[Skipped, ...]) -> Intake:
    """One file a student; where there are several, it is a question and never a guess."""
    skipped = [*left_out, *files.skipped]
    candidates: dict[str, tuple[Student, list[File]]] = {}
    for student, file in files.files:
        if file.can_be_graded:
            candidates.setdefault(student.id, (student, []))[1].append(file)
        else:
            skipped.append(Skipped(file.name, f"not one of {', '.join(SUFFIXES)}"))
    handed_in, questions = [], []
    for _, (student, theirs) in sorted(candidates.items()):
        if len(theirs) == 1:
            handed_in.append(HandedIn(student, theirs[0]))
        else:
            questions.append(Question(student, tuple(file.name for file in theirs)))
    if not candidates:
        kinds = ", ".join(SUFFIXES)
        told = "".join(f"\n  {skip.file}: {skip.why}" for skip in skipped[:10])
        raise IntakeError(f"There is no submission in it: no file that ends with one of {kinds}.{told}")
    return Intake(files.kind, tuple(handed_in), tuple(sorted(skipped, key=lambda s: s.file)), tuple(questions))
