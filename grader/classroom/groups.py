"""Pairs and groups: one submission that counts for several students."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from grader.classroom.formats.format import Upload
from grader.classroom.handed_in import File, SubmissionsError
from grader.classroom.names import comparable, normal
from grader.classroom.roster import generic_student, probably_same
from grader.classroom.tables import table_rows
from grader.grading.grade import Student

#: One attempt: its files, and what their places say.
Attempt = Sequence[tuple[File, Upload]]


@dataclass(frozen=True)
class Unit:
    """What some students handed in together, most often one: their attempts, in order of their texts."""

    students: tuple[Student, ...]
    attempts: Mapping[str, Attempt]


@dataclass(frozen=True)
class Group:
    """A group of the instructor's table."""

    name: str
    members: tuple[Student, ...]

    def has(self, student: Student) -> bool:
        """Return whether this is one of the members."""
        return any(probably_same(member, student) for member in self.members)


def read_groups(table: Path) -> tuple[Group, ...]:
    """Return the groups in a CSV file with the columns group and student, and perhaps name, email and others.

    Raises `SubmissionsError` for a row with a mistake.
    """
    members: dict[str, list[Student]] = defaultdict(list)
    groups: dict[str, str] = {}
    for number, row in table_rows(table, ("group", "student")):
        if not row["group"] or not row["student"]:
            raise SubmissionsError(
                f"{table}:{number}: group = {row['group']!r}, student = {row['student']!r}. Give both."
            )
        if groups.setdefault(normal(row["student"]), row["group"]) != row["group"]:
            raise SubmissionsError(f"{table}:{number}: {row['student']!r} is also in group {groups[row['student']]!r}.")
        members[row["group"]].append(generic_student(row))
    return tuple(Group(name, tuple(students)) for name, students in members.items())


def in_groups(units: Sequence[Unit], groups: Sequence[Group]) -> list[Unit]:
    """Return the units with a group's members in the place of the group, or of the member who handed in for all.

    If several members handed something in, each keeps their own, and the others have nothing.
    """
    left = list(units)
    for group in groups:
        called = [unit for unit in left if any(_is_called(student, group.name) for student in unit.students)]
        by_member = [unit for unit in left if any(group.has(student) for student in unit.students)]
        theirs = called or by_member
        if len(theirs) == 1:
            known = [student for unit in by_member for student in unit.students]
            students = tuple(
                next((student for student in known if probably_same(member, student)), member)
                for member in group.members
            )
            left[left.index(theirs[0])] = replace(theirs[0], students=students)
    return left


def _is_called(student: Student, group: str) -> bool:
    """Return whether a platform means this group: Moodle writes `Group A_12`, Canvas `groupa_345`."""
    name = comparable(group)
    return name in map(comparable, (student.id, student.name, student.lms.get("Group", ""))) and bool(name)
