"""Pairs and groups: one submission that counts for several students."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from grader.classroom.formats.format import UploadedFile
from grader.classroom.names import comparable, normal
from grader.classroom.roster import generic_student, signs
from grader.classroom.submissions import File, SubmissionsError
from grader.classroom.tables import table_rows
from grader.grading.grade import Student

#: One attempt: its files, and what their paths say.
Attempt = Sequence[tuple[File, UploadedFile]]


@dataclass(frozen=True)
class Unit:
    """The attempts of a group of students, or of a single student, by their sort key."""

    students: tuple[Student, ...]
    attempts: Mapping[str, Attempt]


@dataclass(frozen=True)
class Group:
    """A group in the instructor's table."""

    name: str
    members: tuple[Student, ...]


def read_groups(table: Path) -> tuple[Group, ...]:
    """Return the groups in a CSV file with the columns group and student, and optionally name, email and others.

    Raises `SubmissionsError` for a row with a mistake.
    """
    members: dict[str, list[Student]] = defaultdict(list)
    groups: dict[str, str] = {}
    spelled: dict[str, str] = {}
    for number, row in table_rows(table, ("group", "student"), ("name", "email")):
        if not row["group"] or not row["student"]:
            raise SubmissionsError(
                f"{table}:{number}: group = {row['group']!r}, student = {row['student']!r}. Give both."
            )
        if re.search(r"[;\n/&]", row["student"]):
            raise SubmissionsError(f"{table}:{number}: student = {row['student']!r}. Write one row per member.")
        if (before := spelled.setdefault(row["group"].casefold(), row["group"])) != row["group"]:
            raise SubmissionsError(
                f"{table}:{number}: the group {row['group']!r} is {before!r} above. Write it like that, or rename it."
            )
        if groups.setdefault(normal(row["student"]), row["group"]) != row["group"]:
            raise SubmissionsError(f"{table}:{number}: {row['student']!r} is also in group {groups[row['student']]!r}.")
        members[row["group"]].append(generic_student(row))
    return tuple(Group(name, tuple(students)) for name, students in members.items())


def in_groups(units: Sequence[Unit], groups: Sequence[Group]) -> list[Unit]:
    """Return the units, with each group, or the member who handed in for the others, replaced by all members.

    If several members handed something in, each keeps their own submission, and all files together are the others':
    equal programs count for them, different ones are a question.
    """
    placed = dict(enumerate(units))
    called, owned = defaultdict(set), defaultdict(set)
    for number, unit in placed.items():
        for student in unit.students:
            for name in _group_names(student):
                called[name].add(number)
            for sign in signs(student):
                owned[sign].add(number)
    for group in groups:
        by_member = {number for member in group.members for sign in signs(member) for number in owned[sign]}
        theirs = called[comparable(group.name)] or by_member
        if len(theirs) == 1:
            (number,) = theirs
            known = [student for one in by_member for student in units[one].students]
            placed[number] = replace(units[number], students=tuple(_known(member, known) for member in group.members))
        elif theirs:
            own = {sign for number in theirs for student in units[number].students for sign in signs(student)}
            others = tuple(member for member in group.members if not signs(member) & own)
            files = [
                pair for number in sorted(theirs) for attempt in units[number].attempts.values() for pair in attempt
            ]
            placed |= {len(placed): Unit(others, {"": files})} if others else {}
    return list(placed.values())


def _known(member: Student, known: Sequence[Student]) -> Student:
    """Return the member as the export names them, otherwise unchanged."""
    return next((student for student in known if signs(member) & signs(student)), member)


def _group_names(student: Student) -> set[str]:
    """Return the names that platforms may give a group: Moodle writes `Group A_12`, Canvas `groupa_345`."""
    return {comparable(name) for name in (student.id, student.name, student.lms.get("Group", ""))} - {""}
