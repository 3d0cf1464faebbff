"""Tables that an instructor writes as CSV."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path

from grader.intake.handed_in import IntakeError


def rows(table: Path, needed: Sequence[str]) -> list[tuple[int, dict[str, str]]]:
    """The rows, each with its line's number; values without the spaces around them. Empty rows are left out.

    Commas, semicolons and tabs part columns. Raises `IntakeError` when the file can't be read or lacks a column.
    """
    try:
        text = table.read_bytes().decode("utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise IntakeError(f"{table}: it can't be read: {error}. Save it as CSV in UTF-8.") from None
    first = text.partition("\n")[0]
    reader = csv.DictReader(io.StringIO(text), delimiter=max(",;\t", key=first.count), restval="")
    columns = [column.strip() for column in reader.fieldnames or []]
    for column in needed:
        if column not in columns:
            there = ", ".join(columns) or "none"
            raise IntakeError(f"{table}:1: there is no column {column!r} (there are: {there}).")
    reader.fieldnames = columns
    try:
        found = [(reader.line_num, {column: (row[column] or "").strip() for column in columns}) for row in reader]
    except csv.Error as error:
        raise IntakeError(f"{table}:{reader.line_num}: {error}") from None
    return [(number, row) for number, row in found if any(row.values())]
