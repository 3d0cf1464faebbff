"""Times of submission: every spelling is read, or it is an error; days are those of a calendar."""

from __future__ import annotations

from datetime import datetime, timedelta, timezone
from pathlib import Path
from zoneinfo import ZoneInfo

import pytest
from classes import collected, folder

from grader.classroom.deadline import Deadline, lateness
from grader.classroom.times import read_time

UTC, BERLIN = timezone.utc, ZoneInfo("Europe/Berlin")


def read(text: str, near: ZoneInfo | None = None) -> datetime | None:
    return read_time(text, "timestamp.txt", UTC, near).at


@pytest.mark.parametrize(
    ("text", "hour"),
    [
        ("2026-11-22 10:00:00.000000 UTC\n", 10),
        ("\ufeff2026-11-22 10:00:00 UTC\r\n", 10),
        ("2026-11-22 10:00:00 Europe/Berlin", 9),
        ("2026-11-22 10:00:00 CET", 9),
        ("2026-11-22 10:00:00 CEST", 8),
        ("2026-11-22 10:00:00 PST", 18),
        ("2026-11-22 10:00:00 EDT", 14),
        ("2026-11-22 10:00:00 edt", 14),
        ("2026-11-22 10:00:00 +0100", 9),
        ("2026-11-22 10:00:00.5 -03", 13),
        ("2026-11-22 10:00:00 UTC+2", 8),
        ("2026-11-22T10:00:00+01:00", 9),
        ("2026-11-22T10:00:00.123Z", 10),
        ("2026-11-22t10:00z", 10),
        ("2026-11-22 10:00", 10),
        ("2026-11-22 10:00:00.123456 %Z", 10),
        ("2026-11-22 10:00:00 ", 10),
        ("20261122100000123", 10),
        ("Sun Nov 22 10:00:00 CET 2026", 9),
        ("Sun, 22 Nov 2026 10:00:00 +0100", 9),
        ("Sun Nov 22 10:00:00 2026", 10),
        ("20261122T100000Z", 10),
        ("2026/11/22 10:00 (UTC)", 10),
        ("22.11.2026 10:00", 10),
        ("November 22, 2026 at 10:00 AM", 10),
        ("Sunday, 22 November 2026, 10:00\u202fAM", 10),
        ("Sunday, November 22, 2026, 11:00 AM CET", 10),
    ],
)
def test_a_time_is_read_as_it_was_written(text: str, hour: int) -> None:
    assert read(text) == datetime(2026, 11, 22, hour, tzinfo=UTC)


@pytest.mark.parametrize(
    "text",
    ["", "yesterday", "22.13.2026 10:00", "11/22/2026 10:00", "22 mardi 2026 10:00", "2026-11-22 25:00",
     "2026-13-22 10:00", "2026-11-22 10:00 XYZ", "2026-11-22 10:00 Mars/Phobos", "2026-11-22 10:00 ../../etc/passwd",
     "9999-12-31 23:59 -1200", "x" * 10_000],
)  # fmt: skip
def test_what_can_not_be_read_is_an_error_and_never_another_date(text: str) -> None:
    time = read_time(text, "timestamp.txt", UTC)
    assert time.at is None
    assert "is not a time that can be read" in time.fault


def test_an_abbreviation_of_several_zones_is_read_by_the_deadlines_and_reported() -> None:
    china = read_time("2026-11-22 10:00:00 CST", "timestamp.txt", UTC, ZoneInfo("Asia/Shanghai"))
    america = read_time("2026-11-22 10:00:00 CST", "timestamp.txt", UTC, ZoneInfo("America/Chicago"))
    other = read_time("2026-11-22 10:00:00 CST", "timestamp.txt", UTC, BERLIN)
    assert (china.note, america.note) == ("CST was read as UTC+0800", "CST was read as UTC-0600")
    assert other.at == america.at != china.at
    assert read_time("2026-11-22 10:00:00 CET", "timestamp.txt", UTC, BERLIN).note == ""
    assert "read as UTC" in read_time("2026-11-22 10:00:00", "timestamp.txt", UTC, BERLIN).note


@pytest.mark.parametrize(("written", "read"), [("2026-10-25 02:30", "+0200"), ("2026-03-29 02:30", "+0100")])
def test_a_time_that_clocks_have_twice_or_not_at_all_is_said(written: str, read: str) -> None:
    time = read_time(written, "the roster", ZoneInfo("Europe/Berlin"))
    assert time.note == f"{written}, when clocks change, was read as UTC{read}"


def test_a_timestamp_that_can_not_be_read_belongs_to_its_student_alone(tmp_path: Path) -> None:
    made = {f"submitted/s{n}/joint_velocity/node.py": "" for n in range(3)}
    made |= {f"submitted/s{n}/joint_velocity/timestamp.txt": "2026-11-22 10:00 UTC" for n in range(2)}
    made["submitted/s2/joint_velocity/timestamp.txt"] = "soon"
    found = collected(folder(tmp_path / "class", made)).handed_in
    assert [bool(one.file.submitted) for one in found] == [True, True, False]
    assert found[2].file.time.fault == "timestamp.txt says 'soon', which is not a time that can be read"


#: Summer time ends in Berlin on Sunday, 25 October 2026, at 3:00, which is then 2:00 again.
DUE = datetime(2026, 10, 23, 23, 59, tzinfo=BERLIN)


@pytest.mark.parametrize(
    ("handed_in", "days", "text"),
    [
        (datetime(2026, 10, 24, 23, 59, tzinfo=BERLIN), 1, "1 day 0 h"),
        (datetime(2026, 10, 25, 23, 30, tzinfo=BERLIN), 2, "1 day 24 h"),
        (datetime(2026, 10, 25, 23, 59, tzinfo=BERLIN), 2, "2 days 0 h"),
        (datetime(2026, 10, 26, 0, 0, tzinfo=BERLIN), 3, "2 days 0 h"),
        (datetime(2026, 10, 25, 22, 30, tzinfo=UTC), 2, "1 day 24 h"),
        (datetime(2026, 10, 26, 23, 59, tzinfo=BERLIN), 3, "3 days 0 h"),
    ],
)
def test_a_late_day_ends_at_the_same_time_of_day_also_when_clocks_change(
    handed_in: datetime, days: int, text: str
) -> None:
    assert Deadline(DUE, percent=10, zone=BERLIN).lost(handed_in) == 10 * days
    assert lateness(DUE, handed_in, BERLIN) == text


def test_in_spring_a_day_has_23_hours_and_hours_are_always_hours() -> None:
    due = datetime(2026, 3, 28, 12, 0, tzinfo=BERLIN)
    day, hour = (Deadline(due, percent=1, unit=unit, zone=BERLIN) for unit in (timedelta(days=1), timedelta(hours=1)))
    assert day.lost(datetime(2026, 3, 29, 12, 0, tzinfo=BERLIN)) == 1
    assert hour.lost(datetime(2026, 3, 29, 12, 0, tzinfo=BERLIN)) == 23
    assert day.lost(datetime(2026, 3, 29, 12, 1, tzinfo=BERLIN)) == 2


def test_a_grace_of_days_is_by_the_calendar_too() -> None:
    deadline = Deadline(DUE, timedelta(days=2), percent=10, zone=BERLIN)
    assert deadline.lost(datetime(2026, 10, 25, 23, 59, tzinfo=BERLIN)) == 0
