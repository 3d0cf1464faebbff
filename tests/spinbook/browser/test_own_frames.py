"""Tracebacks in a page have the frames of the student's program only."""

from __future__ import annotations

import linecache

import pytest

from spinbook.browser.in_page.own_frames import print_error, with_own_frames

LIBRARY = """\
def call(back):
    try:
        back()
    except ZeroDivisionError as error:
        raise ValueError("no") from error
"""
PROGRAM = "def divide():\n    return 1 / 0\n\ncall(divide)\n"


def failure() -> BaseException:
    """What a program raises in a library that calls it back."""
    names: dict[str, object] = {}
    for file, text in (("/ros.zip/rclpy/node.py", LIBRARY), ("mine.py", PROGRAM)):
        linecache.cache[file] = (len(text), None, text.splitlines(keepends=True), file)
        try:
            exec(compile(text, file, "exec"), names)
        except ValueError as error:
            return error.with_traceback(error.__traceback__.tb_next if error.__traceback__ else None)
    raise AssertionError


def test_the_frames_of_libraries_are_left_out_of_every_error_in_the_chain(capsys: pytest.CaptureFixture[str]) -> None:
    print_error(failure())
    text = capsys.readouterr().err
    assert "ros.zip" not in text
    assert text.count('File "mine.py"') == 2
    assert "return 1 / 0" in text
    assert "ZeroDivisionError: division by zero" in text
    assert text.endswith("ValueError: no\n")


def test_a_log_loses_them_with_their_code_and_nothing_else() -> None:
    log = (
        '[INFO] [a]: File "x" is read\nTraceback (most recent call last):\n'
        '  File "mine.py", line 4, in <module>\n    rclpy.spin(node)\n    ~~~~~~~~~~^^^^^^\n'
        '  File "/ros.zip/rclpy/__init__.py", line 9, in spin\n    executor.spin_once()\n    ^^^^^^^^^^^^^^\n'
        '  File "mine.py", line 2, in heard\n    self.gain\nAttributeError: gain\n'
    )
    short = with_own_frames(log)
    assert "ros.zip" not in short
    assert "spin_once" not in short
    assert [line for line in log.splitlines() if line not in short] == log.splitlines()[5:8]
