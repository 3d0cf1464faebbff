"""A student's name as learning platforms part it."""

from __future__ import annotations

from grader.classroom.entry import Student


def last_and_first(student: Student) -> tuple[str, str]:
    """Last and first name: "Müller, Jörg" is parted at the comma, "Jörg Müller" before the last word."""
    name = student.name.strip()
    if "," in name:
        last, _, first = name.partition(",")
    else:
        first, _, last = name.rpartition(" ")
    return last.strip(), first.strip()


def last_first(student: Student) -> str:
    """The name as Canvas sorts it: "Müller, Jörg"; the id of a student without a name."""
    return ", ".join(filter(None, last_and_first(student))) or student.id
