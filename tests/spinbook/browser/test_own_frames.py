"""Tracebacks in a page have the frames of the student's program only."""

from __future__ import annotations

import linecache

import pytest

from spinbook.browser.in_page.process import print_error

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
