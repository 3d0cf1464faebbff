"""Reads and writes CSV tables, for instructors and platforms."""

from __future__ import annotations

import csv
import io
import re
import unicodedata
from collections.abc import Callable, Iterable, Sequence
from itertools import zip_longest
from pathlib import Path

from grader.classroom.submissions import SubmissionsError
from grader.report.pages import points
from grader.report.printable import printable

Cell = str | float | None

#: Excel reads a CSV file as UTF-8 only if it begins with this. Only the file for people has it.
BYTE_ORDER_MARK = "\ufeff"

#: A spreadsheet treats a text that begins like this as a formula (OWASP, "CSV Injection").
FORMULA = ("=", "+", "-", "@", "\t", "\r", "\n", "＝", "＋", "－", "＠")

LONGEST_CELL = 20_000


def table_rows(table: Path, needed: Sequence[str], more: Sequence[str]) -> list[tuple[int, dict[str, str]]]:
    """Return the rows with their line numbers. Spaces around values are removed, and empty rows are left out.

    Commas, semicolons or tabs separate columns; the columns in `needed` and `more` may be in any case. Raises
    `SubmissionsError` if the file can't be read, lacks a column, or has a row with more values than columns.
    """
    number, columns, rows = _read(table, lambda columns: {*needed} <= {column.casefold() for column in columns})
    known = {column.casefold() for column in columns}
    for column in needed:
        if column not in known:
            raise SubmissionsError(
                f"{table}:{number}: there is no column {column!r} (there are: {', '.join(columns) or 'none'})."
            )
    return _by_column(table, [one.casefold() if one.casefold() in (*needed, *more) else one for one in columns], rows)


def platform_rows(table: Path, is_header: Callable[[dict[str, str]], bool]) -> list[tuple[int, dict[str, str]]]:
    """Return the rows below the header, which may have a title above it. Raises `SubmissionsError` as `table_rows`."""
    _, columns, rows = _read(table, lambda columns: is_header(dict.fromkeys(columns, "1")))
    if not rows:
        raise SubmissionsError(f"{table}: it has no rows below its columns.")
    return _by_column(table, columns, rows)


def _read(table: Path, is_header: Callable[[list[str]], bool]) -> tuple[int, list[str], list[tuple[int, list[str]]]]:
    """Return the header's line and columns, and the rows below it. It is the first line that fits, or the first one."""
    text = _text_of(table)
    hint = re.match(r"sep=(.)\n", text)  # Excel's
    separator = hint[1] if hint else max(",;\t", key="\n".join(text.split("\n")[:5]).count)
    reader = csv.reader(io.StringIO(text, newline=None), delimiter=separator, strict=True)
    try:
        lines = [(reader.line_num, [cell.strip() for cell in cells]) for cells in reader if any(map(str.strip, cells))]
    except csv.Error as error:
        raise SubmissionsError(f"{table}:{reader.line_num}: {error}. Is a quotation mark missing?") from None
    lines = lines[bool(hint) :]
    first = next((index for index, (_, cells) in enumerate(lines[:5]) if is_header(cells)), 0)
    number, columns = lines[first] if lines else (1, [])
    if double := next((column for column in columns if column and columns.count(column) > 1), ""):
        raise SubmissionsError(f"{table}:{number}: two columns are called {double!r}. Rename or remove one of them.")
    return number, columns, lines[first + 1 :]


def _text_of(table: Path) -> str:
    """Return a table's text, in UTF-8 or, as spreadsheets save it with a byte order mark, in UTF-16."""
    try:
        content = table.read_bytes()
        if content.startswith(b"PK\3\4"):
            raise ValueError("it is a spreadsheet")
        text = content.decode("utf-16" if content.startswith((b"\xff\xfe", b"\xfe\xff")) else "utf-8-sig")
        if "\0" in text:
            raise ValueError("it is not a text file")
    except (OSError, ValueError) as error:
        raise SubmissionsError(f"{table}: it can't be read: {error}. Save it as CSV in UTF-8.") from None
    return text.replace("\r\n", "\n").replace("\r", "\n")


def _by_column(
    table: Path, columns: list[str], rows: Sequence[tuple[int, list[str]]]
) -> list[tuple[int, dict[str, str]]]:
    for number, cells in rows:
        if any(cells[len(columns) :]):
            raise SubmissionsError(
                f"{table}:{number}: {len(cells)} values for {len(columns)} columns. Put a value that has a comma in it "
                'into quotation marks: "Müller, Anna".'
            )
    return [(number, dict(zip_longest(columns, cells[: len(columns)], fillvalue=""))) for number, cells in rows]


def csv_text(header: Sequence[str], rows: Iterable[Sequence[Cell]]) -> str:
    """Return header and rows as CSV (RFC 4180): quoted if needed, numbers formatted by `points`, None as an empty cell.

    A text that a spreadsheet would treat as a formula gets an apostrophe in front. Control characters are replaced.
    """
    out = io.StringIO()
    writer = csv.writer(out)
    writer.writerow([_text(name) for name in header])
    writer.writerows(
        [[points(cell) if isinstance(cell, (int, float)) else _text(cell) for cell in row] for row in rows]
    )
    return out.getvalue()


def _text(cell: str | None) -> str:
    # The spaces of names stay, so that a platform finds its students again; what turns the direction of text does not.
    text = "".join(char if unicodedata.category(char) == "Zs" else printable(char) for char in cell or "")
    text = text if len(text) <= LONGEST_CELL else f"{text[:LONGEST_CELL]}…"
    formula = text.lstrip(" ").startswith(FORMULA) and text.strip() != "-"
    return f"'{text}" if formula else text
