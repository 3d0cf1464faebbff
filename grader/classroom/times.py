"""Reads times as platforms and people write them, and counts calendar days."""

from __future__ import annotations

import re
from dataclasses import dataclass
from datetime import datetime, timedelta, timezone, tzinfo
from zoneinfo import ZoneInfo, ZoneInfoNotFoundError

DAY = timedelta(days=1)


@dataclass(frozen=True)
class Time:
    """When work was handed in, as far as it is known.

    `at` has a time zone. `source` says who wrote it, such as "timestamp.txt". `late` is whether the platform marked
    it as late, None if it does not say. `fault` says what can't be read, `note` how something ambiguous was read.
    """

    at: datetime | None = None
    source: str = ""
    late: bool | None = None
    fault: str = ""
    note: str = ""


UNKNOWN = Time()

# Abbreviations are not unique. RFC 5322, section 4.3, defines the American ones; the others are from the IANA time
# zone database. If several zones share one, the deadline's own zone decides, otherwise this table.
_HOURS = {
    "Z": 0, "UTC": 0, "GMT": 0, "WET": 0, "WEST": 1, "BST": 1, "CET": 1, "CEST": 2, "MET": 1, "MEST": 2, "SAST": 2,
    "CAT": 2, "WAT": 1, "EAT": 3, "EET": 2, "EEST": 3, "IDT": 3, "MSK": 3, "PKT": 5, "IST": 5.5, "WIB": 7, "HKT": 8,
    "SGT": 8, "AWST": 8, "JST": 9, "KST": 9, "ACST": 9.5, "ACDT": 10.5, "AEST": 10, "AEDT": 11, "NZST": 12, "NZDT": 13,
    "NST": -3.5, "NDT": -2.5, "AST": -4, "ADT": -3, "EST": -5, "EDT": -4, "CST": -6, "CDT": -5, "MST": -7, "MDT": -6,
    "PST": -8, "PDT": -7, "AKST": -9, "AKDT": -8, "HST": -10, "BRT": -3, "ART": -3,
}  # fmt: skip

#: Each of these means different times in different countries.
_AMBIGUOUS = {"AST", "BST", "CDT", "CST", "EST", "EDT", "IST", "MST", "PST", "WST"}

#: How platforms and people write a time. A date of numbers has its year first, or dots: 11/12/2026 is two dates.
_CLOCK = r"(?P<hour>\d\d?):?(?P<minute>\d\d)(?::?(?P<second>\d\d)(?:[.,]\d+)?)?(?: ?(?P<half>[ap])\.?m\b\.?)?"
_REST = rf"(?:(?:T|,? (?:at )?){_CLOCK})? ?(?P<zone>\S.*)?"
_WRITTEN = tuple(
    re.compile(pattern, re.IGNORECASE)
    for pattern in (
        rf"(?P<year>\d{{4}})([-/]?)(?P<month>\d\d)\2(?P<day>\d\d){_REST}",
        rf"(?P<day>\d\d?)\.(?P<month>\d\d?)\.(?P<year>\d{{4}}){_REST}",
        rf"(?:[a-z]+,? )?(?P<day>\d\d?) (?P<month>[a-z]+)\.?,? (?P<year>\d{{4}}){_REST}",
        rf"(?:[a-z]+,? )?(?P<month>[a-z]+)\.? (?P<day>\d\d?),? (?P<year>\d{{4}}){_REST}",
        rf"[a-z]{{3}} (?P<month>[a-z]{{3}}) (?P<day>\d\d?) {_CLOCK} (?:(?P<zone>\S+) )?(?P<year>\d{{4}})",  # as `date`
    )
)
_MONTHS = (
    *("january", "february", "march", "april", "may", "june"),
    *("july", "august", "september", "october", "november", "december"),
)
_DIGITS = re.compile(r"(\d{14})\d{0,3}")
_OFFSET = re.compile(r"(?:UTC|GMT)?([+-])(\d\d?)(?::?([0-5]\d))?")


def read_time(text: str, source: str, zone: tzinfo | None, near: tzinfo | None = None) -> Time:
    """Return the time that a text contains: a date, a time, and a zone's name, abbreviation or offset.

    `zone` applies to a time without one; `near` is preferred if an abbreviation stands for several zones. None is this
    machine's zone. A text that can't be read becomes the `fault`.
    """
    line = re.sub(r"\s+", " ", next(iter(text.strip("\ufeff \t\r\n\0").splitlines()), "").strip())
    try:
        if digits := _DIGITS.fullmatch(line):  # Sakai's older form, in UTC
            written = datetime.strptime(digits[1], "%Y%m%d%H%M%S")
            return Time(written.replace(tzinfo=timezone.utc), source)
        match = next(filter(None, (pattern.fullmatch(line) for pattern in _WRITTEN)))
        at, note = _in_zone(_as_written(match), (match["zone"] or "").strip("() "), zone, near)
        if at.utcoffset() != at.replace(fold=1).utcoffset():
            note = f"{at:%Y-%m-%d %H:%M}, when clocks change, was read as UTC{at:%z}"
        at.astimezone(timezone.utc)  # times in the years 1 and 9999 can overflow in other zones
    except (StopIteration, ValueError, OverflowError, OSError) as error:
        why = f": {error}" if "zone" in str(error) else ""
        return Time(source=source, fault=f"{source} says {line[:80]!r}, which is not a time that can be read{why}")
    return Time(at, source, note=note)


def _as_written(match: re.Match[str]) -> datetime:
    """Return the time that a pattern matched, without its zone. Raises ValueError."""
    hour = int(match["hour"] or 0)
    if match["half"] and hour <= 12:  # some sites write 13:01 PM
        hour = hour % 12 + 12 * (match["half"].lower() == "p")
    month = int(match["month"]) if match["month"].isdecimal() else _month_named(match["month"].lower())
    return datetime(
        int(match["year"]), month, int(match["day"]), hour, int(match["minute"] or 0), int(match["second"] or 0)
    )


def _month_named(name: str) -> int:
    return next((number for number, full in enumerate(_MONTHS, 1) if name in (full, full[:3], full[:4])), 0)


def _in_zone(written: datetime, name: str, zone: tzinfo | None, near: tzinfo | None) -> tuple[datetime, str]:
    """Return the time with its zone, and how an ambiguous name was read."""
    if name in ("", "%Z"):  # some versions of ngshare leave strftime's %Z in the text
        return localized(written, zone), without_zone(zone)
    if offset := _OFFSET.fullmatch(name.upper()):
        length = timedelta(hours=int(offset[2]), minutes=int(offset[3] or 0))
        return written.replace(tzinfo=timezone(length if offset[1] == "+" else -length)), ""
    if (hours := _HOURS.get(name.upper())) is not None:
        at = written.replace(tzinfo=timezone(timedelta(hours=hours)))
        theirs = localized(written, near)
        if name.upper() == theirs.tzname():
            at = theirs
        return at, f"{name} was read as UTC{at:%z}" if name.upper() in _AMBIGUOUS else ""
    try:
        return written.replace(tzinfo=ZoneInfo(name)), ""
    except (ZoneInfoNotFoundError, ValueError, OSError):
        raise ValueError(f"the time zone {name[:40]!r} is not known") from None


def without_zone(zone: tzinfo | None) -> str:
    """Return a note on how times without a zone are read."""
    return f"a time without a zone was read as {zone or 'local time of this machine'}"


def moment(text: str, zone: tzinfo | None = None) -> datetime | None:
    """Return the time in `2026-11-22 23:59` or any ISO 8601 form; one without a zone is in `zone`. Otherwise None."""
    return read_time(text, "", zone, zone).at


def localized(written: datetime, zone: tzinfo | None) -> datetime:
    """Return a time without a zone as a time in `zone` (None: this machine's)."""
    return written.replace(tzinfo=zone) if zone else written.astimezone()


def later(at: datetime, length: timedelta, zone: tzinfo | None) -> datetime:
    """Return the time `length` after `at`, in UTC: days by the calendar of `zone`, hours and minutes by the clock.

    A day later is the same time on the next day, even if the clocks change in between (RFC 5545, section 3.3.6).
    """
    days, rest = divmod(length, DAY)
    wall = at.astimezone(zone).replace(tzinfo=None) + days * DAY
    return (localized(wall, zone) if days else at).astimezone(timezone.utc) + rest


def units_begun(since: datetime, until: datetime, unit: timedelta, zone: tzinfo | None) -> int:
    """Return how many units have begun between two times. Days and weeks follow the calendar of `zone`."""
    # Python ignores clock changes when it subtracts two times in the same zone, unless it is UTC.
    passed = until.astimezone(timezone.utc) - since.astimezone(timezone.utc)
    begun = max(0, -(-passed // unit) - 1)
    while later(since, begun * unit, zone) < until.astimezone(timezone.utc):
        begun += 1
    return begun


def zone_named(name: str) -> tzinfo:
    """Return an IANA time zone such as Europe/Berlin. Raises ValueError if there is none."""
    try:
        return ZoneInfo(name)
    except (ZoneInfoNotFoundError, ValueError, OSError):
        raise ValueError(f"there is no time zone {name!r}") from None
