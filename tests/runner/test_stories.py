"""How a program's end is reported, if ROS 2 itself says little about the line that is to blame."""

from __future__ import annotations

import pytest

from grader.runner.story import of_exit
from grader.sandbox.monitor import Exit

SOURCE = "import rclpy\nrclpy.spin(node)\n"

#: As rclpy 7.1.6 wrote them, shortened.
NO_RESPONSE = """\
Traceback (most recent call last):
  File "turnstile.py", line 2, in <module>
    rclpy.spin(node)
  File "rclpy/executors.py", line 472, in _execute_service
    srv.send_response(response, header)
  File "rclpy/service.py", line 75, in send_response
    raise TypeError()
TypeError
"""
NO_RESULT = (
    "python: ./action/_rotate_absolute_s.c:145: turtlesim__action__rotate_absolute__result__convert_from_py: Assertion "
    '`strncmp("turtlesim.action._rotate_absolute.RotateAbsolute_Result", full_classname_dest, 55) == 0\' failed.\n'
)


@pytest.mark.parametrize(
    ("log", "exit_", "told"),
    [
        (NO_RESPONSE, Exit(1, None, None), "end each way through it with `return response`"),
        (NO_RESULT, Exit(None, 6, None), "execute callback has to return a Result"),
        ("", Exit(None, 6, None), "killed by signal 6"),
    ],
)
def test_an_end_far_from_its_cause_says_what_to_do(log: str, exit_: Exit, told: str) -> None:
    assert told in of_exit(exit_, log, "turnstile.py", SOURCE)[0]
