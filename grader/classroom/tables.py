"""Reads and writes CSV tables, for instructors and platforms."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence
from pathlib import Path

from grader.classroom.submissions import SubmissionsError
from grader.report.printable import printable

Cell = str | float | None

#: Excel reads a CSV file as UTF-8 only if it begins with this. Only the file for people has it.
BYTE_ORDER_MARK = "\ufeff"

#: A spreadsheet treats a text that begins like this as a formula (OWASP, "CSV Injection").
FORMULA = ("=", "+", "-", "@", "\t", "\r", "\n", "＝", "＋", "－", "＠")

LONGEST_CELL = 20_000


def table_rows(table: Path, needed: Sequence[str]) -> list[tuple[int, dict[str, str]]]:
    """Return the rows with their line numbers. Spaces around values are removed, and empty rows are left out.

    Commas, semicolons or tabs separate columns. Raises `SubmissionsError` if the file can't be read or lacks a column.
    """
    try:
        text = table.read_bytes().decode("utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise SubmissionsError(f"{table}: it can't be read: {error}. Save it as CSV in UTF-8.") from None
    first = text.partition("\n")[0]
    reader = csv.DictReader(io.StringIO(text), delimiter=max(",;\t", key=first.count), restval="")
    columns = [column.strip() for column in reader.fieldnames or []]
    for column in needed:
        if column not in columns:
            there = ", ".join(columns) or "none"
            raise SubmissionsError(f"{table}:1: there is no column {column!r} (there are: {there}).")
    reader.fieldnames = columns
    try:
        rows = [(reader.line_num, {column: (row[column] or "").strip() for column in columns}) for row in reader]
    except csv.Error as error:
        raise SubmissionsError(f"{table}:{reader.line_num}: {error}") from None
    return [(number, row) for number, row in rows if any(row.values())]


def csv_text(header: Sequence[str], rows: Iterable[Sequence[Cell]]) -> str:
    """Return header and rows as CSV (RFC 4180): quoted if needed, numbers formatted by `number`, None as an empty cell.

    A text that a spreadsheet would treat as a formula gets an apostrophe in front. Control characters are replaced.
    """
    out = io.StringIO()
    writer = csv.writer(out)
    writer.writerow([_text(name) for name in header])
    writer.writerows(
        [[number(cell) if isinstance(cell, (int, float)) else _text(cell) for cell in row] for row in rows]
    )
    return out.getvalue()


def number(value: float) -> str:
    """Return points with at most two decimals, as learning platforms store them: 81, 80.5, 33.33."""
    return f"{value:.2f}".rstrip("0").rstrip(".")


def _text(cell: str | None) -> str:
    text = printable(cell or "", LONGEST_CELL)
    formula = text.lstrip(" ").startswith(FORMULA) and text.strip() != "-"
    return f"'{text}" if formula else text
