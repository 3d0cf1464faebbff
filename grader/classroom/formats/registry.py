"""Every format, in the order in which they are tried."""

from __future__ import annotations

from grader.classroom.formats import (
    blackboard,
    brightspace,
    canvas,
    gradescope,
    ilias,
    moodle,
    nbgrader,
    per_student,
    sakai,
)
from grader.classroom.formats.format import ExportTable, Format

PLATFORMS: tuple[Format, ...] = (
    nbgrader.FORMAT,
    moodle.FORMAT,
    canvas.FORMAT,
    gradescope.FORMAT,
    blackboard.FORMAT,
    brightspace.FORMAT,
    sakai.FORMAT,
    ilias.FORMAT,
)

#: The format of a folder that no platform wrote.
PLAIN = per_student.FORMAT

FORMATS = {form.name: form for form in (*PLATFORMS, PLAIN)}

#: The tables of grades that platforms import.
TABLES: tuple[ExportTable, ...] = tuple(form.table for form in PLATFORMS if form.table)
