"""Points in time, as people write them in tables."""

from __future__ import annotations

from datetime import datetime


def moment(text: str) -> datetime | None:
    """`2026-11-22 23:59`, or any ISO 8601 form; this machine's time zone where none is named. None for other texts."""
    try:
        # Python 3.10 knows no Z.
        written = datetime.fromisoformat(text.strip().replace("Z", "+00:00"))
        return written if written.tzinfo else written.astimezone()
    except (ValueError, OverflowError):
        return None
