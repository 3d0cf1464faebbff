"""What the end of a program's output says, for the student who wrote it."""

from __future__ import annotations

import re
from dataclasses import dataclass

from grader.runner.student import Exit

FRAME = re.compile(r'^\s*File "(?P<file>[^"]+)", line (?P<line>\d+)', re.MULTILINE)
TRACEBACK = "Traceback (most recent call last):"
LIMITS = {
    "cpu": "it used more computing time than a node may",
    "memory": "it used more memory than a node may",
    "processes": "it started more processes than a node may",
    "file-size": "it wrote more to disk than a node may",
    "output": "it printed more than a node may",
    "wall": "it ran longer than a node may",
}


#: What ROS 2's C code prints before it aborts a program that gave it an object of another class (rosidl_generator_py).
OTHER_CLASS = re.compile(r'__convert_from_py: Assertion .strncmp\("(?:\w+\.)+(?P<expected>\w+)"')

_RESULT = "An action's execute callback has to return a Result, such as `return Fibonacci.Result()`."


@dataclass(frozen=True)
class LastWords:
    """The error that ended a program: its last line, such as `ZeroDivisionError: float division by zero`, and the line
    of the student's file that raised it, if there is one."""

    error: str
    line: int | None
    text: str = ""


def last_words(log: str, file_name: str, source: str = "") -> LastWords | None:
    """Return the last error in `log`, or None if there is none."""
    start = log.rfind(TRACEBACK)
    if start < 0:
        start = log.rfind('  File "')
        if start < 0:
            return None
    block = log[start:]
    error = ""
    for row in block.splitlines()[1:]:
        if row and not row[0].isspace() and re.match(r"[A-Za-z_][\w.]*(:|$)", row):
            error = row.strip()
            break
    lines = [int(m["line"]) for m in FRAME.finditer(block) if m["file"].rpartition("/")[2] == file_name]
    line = lines[-1] if lines else None
    rows = source.splitlines()
    return LastWords(error, line, rows[line - 1].strip() if line and line <= len(rows) else "")


def is_rclpys_own(log: str, file_name: str, source: str) -> bool:
    """Return whether the last error in `log` is a race in rclpy, and so not the fault of a correct program.

    On Ctrl-C a thread of rclpy shuts ROS 2 down. If it does so between the `ok()` and the `shutdown()` of a program
    that checks first, as `rclpy.try_shutdown()` does, the program's call fails (rclpy 7.1, `Context.try_shutdown`).
    """
    words = last_words(log, file_name, source)
    if words is None or "rcl_shutdown already called" not in words.error:
        return False
    if ", in try_shutdown" in log[log.rfind(TRACEBACK) :]:
        return True
    rows = source.splitlines()[: words.line or 0]
    return any("ok()" in row for row in rows[-2:])


def _advice(error: str, block: str) -> str:
    """Return advice about an error that rclpy raises far from the student's line which caused it (rclpy 7.1)."""
    if error.startswith("TypeError") and ", in send_response" in block:
        return ". A service's callback has to return the response: end each way through it with `return response`."
    if ", in _execute_goal" in block or ", in _send_result_response" in block:
        return f". {_RESULT}"
    return ""


def _of_signal(signal: int, log: str) -> str:
    if other := OTHER_CLASS.search(log):
        text = f"it gave ROS 2 an object of another class than {other['expected']}."
        return f"{text} {_RESULT}" if other["expected"].endswith("_Result") else text
    return f"it was killed by signal {signal}."


def of_exit(exit_: Exit, log: str, file_name: str, source: str) -> tuple[str, int | None]:
    """Return why a program ended, as a clause that follows "Your program ended: ", and the line to blame."""
    if exit_.limit:
        return f"{LIMITS.get(exit_.limit, exit_.limit)}.", None
    words = last_words(log, file_name, source)
    if words and words.error:
        advice = _advice(words.error, log[log.rfind(TRACEBACK) :])
        place = f" in line {words.line}" if words.line else ""
        text = f": {words.text}" if words.text else ""
        return f"{words.error}{place}{text}{advice}", words.line
    if exit_.signal:
        return _of_signal(exit_.signal, log), None
    if exit_.code == 0:
        return "it came to its end by itself, before it was asked to.", None
    return f"it gave up with exit code {exit_.code}.", None
