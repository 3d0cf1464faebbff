"""A table as CSV that no spreadsheet takes for a program."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence

from grader.report.printable import printable

Cell = str | float | None

#: A text that begins like this is a formula to a spreadsheet (OWASP, "CSV Injection").
FORMULA = ("=", "+", "-", "@", "\t", "\r", "\n", "＝", "＋", "－", "＠")

LONGEST_CELL = 20_000


def csv_text(header: Sequence[str], rows: Iterable[Sequence[Cell]]) -> str:
    """Header and rows as CSV (RFC 4180): quoted where needed, numbers as `number` writes them, None as nothing.

    A text that a spreadsheet would take for a formula gets an apostrophe in front of it. Control characters are
    replaced.
    """
    out = io.StringIO()
    writer = csv.writer(out)
    writer.writerow([_text(name) for name in header])
    writer.writerows(
        [[number(cell) if isinstance(cell, (int, float)) else _text(cell) for cell in row] for row in rows]
    )
    return out.getvalue()


def number(value: float) -> str:
    """Points with two decimals at most, as learning platforms keep them: 81, 80.5, 33.33."""
    return f"{value:.2f}".rstrip("0").rstrip(".")


def _text(cell: str | None) -> str:
    text = printable(cell or "", LONGEST_CELL)
    formula = text.lstrip(" ").startswith(FORMULA) and text.strip() != "-"
    return f"'{text}" if formula else text
