"""Log levels, and log lines on standard error.

As rcutils does it (rcutils/logging.h): levels are inherited along the dots of a logger's name, and
RCUTILS_CONSOLE_OUTPUT_FORMAT says what a line looks like.
"""

from __future__ import annotations

import datetime
import os
import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from rcl_python import participant

_DEFAULT = 20
_FORMAT = "[{severity}] [{time}] [{name}]: {message}"
_NAMES = {0: "UNSET", 10: "DEBUG", 20: "INFO", 30: "WARN", 40: "ERROR", 50: "FATAL"}
_COLOURS = {10: "\033[32m", 20: "\033[0m", 30: "\033[33m", 40: "\033[31m", 50: "\033[31m"}

_levels: dict[str, int] = {}
_rosout: dict[str, list[Callable[[Any], None]]] = {}
"""The functions that publish lines on /rosout, by the logger's name."""


def _to_standard_error(line: str) -> None:
    stream = sys.__stderr__
    if stream is not None:
        stream.write(line + "\n")
        stream.flush()


write: Callable[[str], None] = _to_standard_error
"""Where log lines go."""


def set_level(name: str, level: int, detailed_error: bool = False) -> None:
    """Set a logger's level; 0 lets it inherit again. Raises RuntimeError for an invalid level."""
    if int(level) not in _NAMES:
        reason = f"Failed reason: Unable to determine severity_string for severity: {level}"
        raise RuntimeError(reason if detailed_error else "Failed to set level for logger")
    _levels[name] = int(level)


def get_level(name: str) -> int:
    """Return a logger's own level, 0 if it has none."""
    return _levels.get(name, 0)


def effective_level(name: str) -> int:
    """Return a logger's level: its own, otherwise its nearest ancestor's, otherwise the default."""
    while name:
        if _levels.get(name):
            return _levels[name]
        name = name.rpartition(".")[0]
    return _levels.get("", _DEFAULT)


def is_enabled_for(name: str, severity: int) -> bool:
    """Return whether a logger prints lines of this severity."""
    return int(severity) >= effective_level(name)


def severity_from(text: str) -> int:
    """Return the number of a severity's name. Raises RuntimeError for any other word."""
    for number, name in _NAMES.items():
        if name == text.upper():
            return number
    raise RuntimeError("Failed to get severity name")


def directory() -> str:
    """Return where log files would go (rcl_logging_interface)."""
    home = os.environ.get("ROS_HOME") or os.path.join("~", ".ros")  # noqa: PTH118
    return str(Path(os.environ.get("ROS_LOG_DIR") or os.path.join(home, "log")).expanduser())  # noqa: PTH118


def shutdown() -> None:
    """Forget every level."""
    _levels.clear()


def log(severity: int, name: str, message: str, function: str, file: str, line: int) -> None:
    """Write a line if the logger's level allows it, and publish it on /rosout."""
    if not is_enabled_for(name, severity):
        return
    now = participant.current().link.system()
    text = _line(int(severity), name, message, function, file, line, now)
    colour = _COLOURS.get(int(severity), "") if os.environ.get("RCUTILS_COLORIZED_OUTPUT") == "1" else ""
    write(f"{colour}{text}\033[0m" if colour else text)
    if name in _rosout:
        record = _record(int(severity), name, message, function, file, line, now)
        for publish in _rosout[name]:
            publish(record)


def _line(severity: int, name: str, message: str, function: str, file: str, line: int, now: int) -> str:
    values = {
        "severity": _NAMES.get(severity, ""),
        "name": name,
        "message": message,
        "time": f"{now // 10**9}.{now % 10**9:09d}",
        "time_as_nanoseconds": str(now),
        "date_time_with_ms": _date(now),
        "function_name": function,
        "file_name": file,
        "line_number": str(line),
    }
    form = os.environ.get("RCUTILS_CONSOLE_OUTPUT_FORMAT") or _FORMAT
    return re.sub(r"\{(\w+)\}", lambda found: values.get(found[1], found[0]), form)


def _date(now: int) -> str:
    moment = datetime.datetime.fromtimestamp(now // 10**9)
    return f"{moment:%Y-%m-%d %H:%M:%S}.{now // 10**6 % 1000:03d}"


def _record(severity: int, name: str, message: str, function: str, file: str, line: int, now: int) -> Any:
    from builtin_interfaces.msg import Time
    from rcl_interfaces.msg import Log

    stamp = Time(sec=now // 10**9, nanosec=now % 10**9)
    return Log(stamp=stamp, level=severity, name=name, msg=message, file=file, function=function, line=line)


def add_rosout(name: str, publish: Callable[[Any], None]) -> None:
    """Publish the lines of the logger `name` with `publish`."""
    _rosout.setdefault(name, []).append(publish)


def remove_rosout(name: str, publish: Callable[[Any], None]) -> None:
    """Stop publishing them, and those of the loggers below it."""
    for logger in list(_rosout):
        if publish in _rosout[logger] and (logger == name or logger.startswith(f"{name}.")):
            _rosout[logger].remove(publish)
            if not _rosout[logger]:
                del _rosout[logger]


def add_sublogger(name: str, child: str) -> bool:
    """Publish the lines of `name.child` as those of `name`. Return False if those are not published."""
    if name not in _rosout:
        return False
    _rosout.setdefault(f"{name}.{child}", []).append(_rosout[name][0])
    return True


def remove_sublogger(name: str, child: str) -> None:
    """Undo one `add_sublogger`."""
    logger = f"{name}.{child}"
    if _rosout.get(logger):
        _rosout[logger].pop()
        if not _rosout[logger]:
            del _rosout[logger]
