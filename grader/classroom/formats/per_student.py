"""One file, or one folder, per student: `anna.py`, `carl/joint_velocity.py`."""

from __future__ import annotations

import re
from collections.abc import Callable

from grader.classroom.formats.format import Export, Format, Interpretation, Parts, UploadedFile, person
from grader.classroom.names import comparable, normal, student_id
from grader.classroom.times import UNKNOWN
from grader.submission.file_kinds import kind_of, kind_of_content, original_name

SUFFIX = re.compile(r"(\.(py|ipynb|launch|tar)\.\w+|\.[^.]+)$", re.IGNORECASE)

#: Instructors' own tables and notes, next to the submissions. Any other page or note may be what a student handed in.
NOT_WORK = re.compile(r".*\.(?:csv|tsv|xlsx?|ods|ya?ml|toml)|(?:readme|licen[sc]e|index)(?:\.\w+)?", re.IGNORECASE)


def read(export: Export) -> Callable[[Parts], Interpretation]:
    """Return how to read the paths: every name is a student's; `anna (1).py` is anna's, unless there is `anna (2).py`.

    If `anna.py` is there as well, all three are anna's.
    """
    names = {_name(parts): _name((original_name(parts[0]), *parts[1:])) for parts in export.files}
    originals = list(names.values())
    exercise = export.exercise
    of_exercise = {comparable(exercise.name), comparable(without_suffix(exercise.file_name))}

    def understand(parts: Parts) -> Interpretation:
        is_work = len(parts) > 1 or kind_of(parts[0]) == "launch file"
        if (
            not is_work
            and NOT_WORK.fullmatch(parts[0])
            and not (export.exercise.nodes and kind_of_content(export.text(*parts).encode(), "other") == "launch file")
        ):
            return "a table, a note or a page, not a submission"
        name = _name(parts)
        while names.get(name, name) != name and (names[name] in names or originals.count(names[name]) == 1):
            name = names[name]  # a copy may be one of a copy
        if len(parts) == 1 and comparable(name) in of_exercise:
            return None
        file = export.files.get(parts)
        student = person(name, name if name != student_id(name) else "")
        return UploadedFile((student,), parts[1:] or parts, time=file.time if file else UNKNOWN)

    return understand


def _name(parts: Parts) -> str:
    return normal(parts[0]) if len(parts) > 1 else without_suffix(parts[0])


def without_suffix(name: str) -> str:
    """Return the student's name from a file's name."""
    return normal(SUFFIX.sub("", name) or name)


FORMAT = Format("folder", "a folder with one file (or one folder) per student", read)
