"""Finds the error that ended a program in its output."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

from grader.recording.places import place_of

HEADER = "Traceback (most recent call last):"

_FRAME = re.compile(r'^[ \t]*File "(?P<file>[^"]+)", line (?P<line>\d{1,9})', re.MULTILINE)
#: What `ros2 launch` prints before each line of a program.
_OF_A_LAUNCH = re.compile(r"^\[[\w.-]+-\d+\] ", re.MULTILINE)
_ERROR = re.compile(r"[A-Za-z_][\w.]*(:|$)")

#: A line of an error or of a program is as long as the student likes; more characters than this do not help.
_LONGEST_ROW = 500

#: At most this many folders above a student's file are compared with a traceback's path.
_DEEPEST = 20

#: The beginning of the traceback of an uncaught exception in the main thread: it starts in the module itself.
_OF_THE_PROGRAM = re.compile(re.escape(HEADER) + r'\n[ \t]*File "[^"]+", line \d{1,9}, in <module>\n')

#: Where an object is in memory, which is another place in each run; where rclpy's C++ has an exception, and raises it;
#: where a module is; a cause that nobody has who has no ROS 1.
_OF_A_LIBRARY = re.compile(
    r" at 0x[0-9a-f]{4,16}\b|^rclpy\._rclpy_pybind11\.|, at /\S+:\d+$| \(/\S+\)$| This might be a ROS 1 .*"
)

#: The cause of an error in C++, which stands before it: the error itself says nothing.
_CAUSE = re.compile(r"(?:^|\n)(\w+: .*)\n\nThe above exception was the direct cause[^\n]*\n+$")

#: The text of a SyntaxError has no header.
_OF_A_SYNTAX_ERROR = '  File "'


@dataclass(frozen=True)
class LastError:
    """The error that ended a program: its last line, such as `ZeroDivisionError: float division by zero`, and the line
    of the student's `file` that raised it, or from which it was called, if there is one; that of a callback
    with which a library could not do anything.

    `place` is both in words: "line 5", with the file if there are several, and with the notebook's cell if the program
    has several. `raised_there` is whether this line itself raised it, and `traceback` is the whole text, up to the
    error.
    """

    error: str
    line: int | None
    text: str = ""
    raised_there: bool = False
    traceback: str = ""
    file: str = ""
    place: str = ""

    @property
    def where(self) -> str:
        """The place and its line, to be appended to a sentence; "" if neither is known."""
        return (f" in {self.place}" if self.place else "") + (f": `{self.text}`" if self.text else "")


def last_error(log: str, sources: Mapping[str, str]) -> LastError | None:
    """Return the last error in `log`, or None if there is none. `sources` are the student's files: path -> text.

    An error in the main thread takes precedence over one that another thread printed later, as rclpy does for a goal in
    progress.
    """
    log = _OF_A_LAUNCH.sub("", log)
    start = _beginning(log)
    if start < 0:
        return None
    rows = log[start:].splitlines()
    ends = (number for number, row in enumerate(rows, 1) if number > 1 and _ERROR.match(row))
    rows = rows[: next(ends, len(rows))]
    caused = "returned a result with an exception set" in rows[-1] and _CAUSE.search(log[:start])
    error = _shortened(caused[1] if caused else rows[-1].strip()) if _ERROR.match(rows[-1]) else ""
    block = "\n".join(rows)
    frames = [(_own(m["file"], sources), int(m["line"])) for m in _FRAME.finditer(block)]
    own = [frame for frame in frames if frame[0]]
    if not own:
        return LastError(error, None, traceback=block)
    file, line = own[-1]
    raised_there = frames[-1:] == [(file, line)]
    line = line if raised_there else _callback_line(error, sources[file]) or line
    return LastError(error, line, _row(sources[file], line), raised_there, block, file, _place(file, line, sources))


def aborting_line(log: str, sources: Mapping[str, str]) -> LastError | None:
    """Return the line of the student's that called what aborted the program in C, which has no error; None if none."""
    for frame in _FRAME.finditer(log.rpartition("Fatal Python error: Aborted\n")[2]):
        if file := _own(frame["file"], sources):
            line = int(frame["line"])
            return LastError("", line, _row(sources[file], line), place=_place(file, line, sources))
    return None


#: The line to blame for an error that a library raises when it calls a callback, by a pattern of the error: the
#: callback that takes other arguments; the one that was called instead of given.
_CALLBACK_LINES = (
    (r"TypeError: (?:\w+\.)*(\w+)\(\) (?:takes|missing) \d", r"\s*(?:async )?def \1\("),
    (r"TypeError: ('NoneType') object is not callable", r".*\b(?:create_\w+|ActionServer)\(.*\bself\.\w+\(\)"),
)


def _callback_line(error: str, source: str) -> int | None:
    """Return the line to blame for what a library raised; None unless there is exactly one."""
    for what, where in _CALLBACK_LINES:
        if match := re.match(what, error):
            pattern = where.replace(r"\1", match[1])
            rows = enumerate(source.splitlines(), 1)
            lines = [number for number, row in rows if re.match(pattern, row[:_LONGEST_ROW])]
            return lines[0] if len(lines) == 1 else None
    return None


#: What stands between the tracebacks of one error and of the error that led to it.
_CHAINED = ("During handling of the above exception", "The above exception was the direct cause")


def first_error(log: str, sources: Mapping[str, str]) -> LastError | None:
    """Return the first error in `log` that a line of the student's raised or led to; None if there is none."""
    parts = _OF_A_LAUNCH.sub("", log).split(HEADER)
    for number, part in enumerate(parts[1:], start=1):
        if any(words in part for words in _CHAINED) and number < len(parts) - 1:
            continue
        error = last_error(HEADER + part, sources)
        if error and error.error and error.line:
            return error
    return None


#: A place in a traceback or in a warning: `File "heartbeat.py", line 5`, `heartbeat.py:5: DeprecationWarning`.
_PLACES = re.compile(
    r'File "(?P<file>[^"\n]+)", line (?P<line>\d{1,9})|^(?P<path>\S+\.py):(?P<number>\d{1,9})(?=: )', re.MULTILINE
)


def in_cells(log: str, sources: Mapping[str, str]) -> str:
    """Return what a program printed, with the lines of a notebook's cells in place of an assembled program's lines."""

    def in_cell(place: re.Match[str]) -> str:
        file = _own(place["file"] or place["path"], sources)
        cell, line = place_of(sources[file], int(place["line"] or place["number"])) if file else (0, 0)
        return f"code cell {cell}, line {line}" if cell else place[0]

    return _PLACES.sub(in_cell, log)


def _own(path: str, sources: Mapping[str, str]) -> str:
    """Return which of the student's files a path means; "" if none."""
    parts = path.rsplit("/", _DEEPEST)
    return next((file for i in range(len(parts)) if (file := "/".join(parts[i:])) in sources), "")


def _place(file: str, line: int, sources: Mapping[str, str]) -> str:
    cell, own_line = place_of(sources[file], line)
    if cell:
        return f"line {own_line} of code cell {cell}"
    return f"line {line} of {file}" if len(sources) > 1 else f"line {line}"


def _beginning(log: str) -> int:
    *_, last = (-1, *(match.start() for match in _OF_THE_PROGRAM.finditer(log)))
    if last < 0:
        last = log.rfind(HEADER)
    return last if last >= 0 else log.rfind(_OF_A_SYNTAX_ERROR)


def _shortened(error: str) -> str:
    error = _OF_A_LIBRARY.sub("", error).removesuffix(" The following argument types are supported:")
    return _at_most(error)


def _at_most(text: str) -> str:
    """Return a text that no pattern takes long for, whatever a student wrote."""
    return text if len(text) <= _LONGEST_ROW else f"{text[:_LONGEST_ROW]}…"


def _row(source: str, line: int) -> str:
    rows = source.splitlines()
    return _at_most(rows[line - 1].strip()) if 0 < line <= len(rows) else ""


def error_on_interrupt(before: str, log: str, sources: Mapping[str, str]) -> str:
    """Return the last line of the error that a program printed after it was interrupted; "" if it printed none.

    `before` is what it had printed until then, and `log` is everything.
    """
    if log.count(HEADER) <= before.count(HEADER):
        return ""
    last = last_error(log.removeprefix(before), sources)
    return "" if last is None or _is_rclpys_own(last, sources.get(last.file, "")) else last.error


def _is_rclpys_own(last: LastError, source: str) -> bool:
    """Return whether an error is a race in rclpy, and so not the fault of a correct program.

    On Ctrl-C a thread of rclpy shuts ROS 2 down. If it does so between the `ok()` and the `shutdown()` of a program
    that checks first, as `rclpy.try_shutdown()` does, the program's call fails (rclpy 7.1, `Context.try_shutdown`).
    """
    if "rcl_shutdown already called" not in last.error:
        return False
    if ", in try_shutdown" in last.traceback:
        return True
    rows = source.splitlines()[: last.line or 0]
    return any("ok()" in row for row in rows[-2:])
