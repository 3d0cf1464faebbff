"""What a program printed reaches a student with the frames and the names that the student knows."""

from __future__ import annotations

import sys
import threading
from sysconfig import get_path

import pytest

from grader.recording.printed_paths import with_own_frames, without_paths


def test_files_in_tracebacks_have_the_names_that_a_student_knows() -> None:
    assert without_paths('  File "/submission/talker.py", line 3\n') == '  File "talker.py", line 3\n'


def test_the_environment_is_left_out_of_whatever_else_was_printed() -> None:
    assert without_paths(f"in {sys.prefix} and {sys.prefix}/bin/python") == "in  and bin/python"
    assert without_paths(f"{sys.prefix}-of-mine") == f"{sys.prefix}-of-mine"


LIBRARIES = (f"{get_path('purelib')}/rclpy/task.py", threading.__file__, "<frozen runpy>", "/ros.zip/rclpy/task.py")


@pytest.mark.parametrize("library", LIBRARIES)
@pytest.mark.parametrize("launched", ["", "[talker-1] "])
def test_a_traceback_loses_the_frames_of_libraries_with_their_code_and_nothing_else(
    library: str, launched: str
) -> None:
    log = (
        '[INFO] [a]: File "x" is read\nTraceback (most recent call last):\n'
        '  File "mine.py", line 4, in <module>\n    rclpy.spin(node)\n    ~~~~~~~~~~^^^^^^\n'
        f'  File "{library}", line 9, in spin\n    executor.spin_once()\n    ^^^^^^^^^^^^^^\n'
        "  [Previous line repeated 3 more times]\n"
        '  File "mine.py", line 2, in heard\n    self.gain\nAttributeError: gain\n'
    )
    lines = [launched + line for line in log.splitlines(keepends=True)]
    assert with_own_frames("".join(lines)) == "".join(lines[:5] + lines[9:])


def test_spaces_without_end_behind_a_frame_do_not_keep_the_grader_busy() -> None:
    printed = '  File "talker.py", line 3\n' + " " * 2_000_000
    assert with_own_frames(printed) == printed
