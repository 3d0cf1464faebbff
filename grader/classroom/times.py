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

_WRITTEN = re.compile(
    r"(?P<day>\d{4}-\d\d-\d\d)(?:[ T]+(?P<time>\d\d:\d\d(?::\d\d)?)(?:[.,]\d+)?)?\s*(?P<zone>\S.*)?",
    re.IGNORECASE,
)
#: As `date` and `date -R` write them: "Sun Nov 22 10:00:00 UTC 2026", "Sun, 22 Nov 2026 10:00:00 +0100".
_MONTHS = ("jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec")
_WORDED = (
    re.compile(r"[a-z]{3} (?P<month>[a-z]{3}) +(?P<day>\d\d?) (?P<time>[\d:]+) (?P<zone>\S+) (?P<year>\d{4})", re.I),
    re.compile(
        r"(?:[a-z]{3}, )?(?P<day>\d\d?) (?P<month>[a-z]{3}) (?P<year>\d{4}) (?P<time>[\d:]+) ?(?P<zone>.*)", re.I
    ),
)
_DIGITS = re.compile(r"(\d{14})\d{0,3}")
_OFFSET = re.compile(r"(?:UTC|GMT)?([+-])(\d\d?)(?::?([0-5]\d))?")


def read_time(text: str, source: str, zone: tzinfo | None, near: tzinfo | None = None) -> Time:
    """Return the time that a text contains: a date, a time, and a zone's name, abbreviation or offset.

    `zone` applies to a time without one; `near` is preferred if an abbreviation stands for several zones. None is this
    machine's zone. A text that can't be read becomes the `fault`.
    """
    line = next(iter(text.strip("\ufeff \t\r\n\0").splitlines()), "").strip()
    try:
        match, digits = _WRITTEN.fullmatch(_in_digits(line)), _DIGITS.fullmatch(line)
        if digits:  # Sakai's older form, in UTC
            written = datetime.strptime(digits[1], "%Y%m%d%H%M%S")
            return Time(written.replace(tzinfo=timezone.utc), source)
        if not match:
            raise ValueError
        written = datetime.fromisoformat(f"{match['day']} {match['time'] or '00:00'}")
        at, note = _in_zone(written, (match["zone"] or "").strip(), zone, near)
        at.astimezone(timezone.utc)  # times in the years 1 and 9999 can overflow in other zones
    except (ValueError, OverflowError, OSError) as error:
        why = f": {error}" if "zone" in str(error) else ""
        return Time(source=source, fault=f"{source} says {line[:80]!r}, which is not a time that can be read{why}")
    return Time(at, source, note=note)


def month_named(name: str) -> int:
    """Return the number of a month from its English name or the first letters. Raises ValueError."""
    return _MONTHS.index(name[:3].lower()) + 1


def _in_digits(line: str) -> str:
    """Return a time with a month's name in digits; any other text is returned unchanged."""
    for worded in _WORDED:
        if match := worded.fullmatch(line):
            day = f"{match['year']}-{month_named(match['month']):02}-{int(match['day']):02}"
            return f"{day} {match['time']} {match['zone']}"
    return line


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
