"""What goes wrong in a node is read from its output and its exit code."""

from __future__ import annotations

from pathlib import Path

import pytest

from spinbook.kernel.node_errors import NodeError, NodeLog, describe, ended_badly, how_it_ended
from spinbook.kernel.reader_frames import ReaderFrames

RAISED = 'Traceback (most recent call last):\n  File "/ws/arm.py", line 9, in go\n    a.b\nValueError: no grip\n'
CTRL_C = 'Traceback (most recent call last):\n  File "/ws/arm.py", line 3, in <module>\nKeyboardInterrupt\n'
AGAIN = "\nDuring handling of the above exception, another exception occurred:\n\n"
SHUT_DOWN = "\n".join(
    [
        "Traceback (most recent call last):",
        '  File "/ws/arm.py", line 30, in main',
        "rclpy._rclpy_pybind11.RCLError: failed to shutdown: rcl_shutdown already called on the given context",
        "",
    ]
)


def report(text: str, *, ended: str = "", stopping: bool = False) -> NodeError | None:
    log = NodeLog()
    for letter in (text[:40], text[40:]):
        log.add(letter, stopping=stopping)
    return describe("arm", log, ended)


@pytest.mark.parametrize("above", ["\n# %%node arm\n", "import math\n\n\n# %%node arm (line 2)\n"])
def test_an_exception_is_reported_with_the_line_of_its_cell(tmp_path: Path, above: str) -> None:
    file = tmp_path / "arm.py"
    file.write_text(f"{above}\n\n\n\n\n\na.b\n")
    line = above.count("\n") + 7
    raised = RAISED.replace("/ws/arm.py", str(file)).replace("line 9", f"line {line}")
    error = report(raised, ended="ended with exit code 1.")

    assert error is not None
    assert (error.file, error.line) == ("arm.py", 9)
    assert error.what == "ValueError: no grip. It ended with exit code 1."
    assert error.in_words.splitlines()[0] == "✗ arm: arm.py, line 9: ValueError: no grip. It ended with exit code 1."


@pytest.mark.parametrize(
    ("text", "what"),
    [
        ("[ERROR] [arm]: too hot\n", "it logged ERROR: too hot."),
        ("[FATAL] [1700000000.123] [arm.left]: on fire\n", "it logged FATAL: on fire."),
        ("\x1b[31m[ERROR] [1.2] [arm]: too hot\x1b[0m\n", "it logged ERROR: too hot."),
        ("ERROR:root:too hot\n", "it logged ERROR: too hot."),
        ("The following exception was never retrieved: no grip\n", "an exception was lost: no grip."),
        ("[arm-1] [ERROR] [arm]: too hot\n", "it logged ERROR: too hot."),
        ("[ERROR] [arm]: Error raised in execute callback: no grip\n" + RAISED, "ValueError: no grip."),
        ("Exception in thread Thread-1 (go):\n" + RAISED, "ValueError: no grip."),
        (RAISED + AGAIN + RAISED.replace("no grip", "worse"), "ValueError: worse."),
        ("[ERROR] [arm]: a\n[ERROR] [arm]: b\n[ERROR] [arm]: a\n", "it logged ERROR: a (and 1 more)."),
    ],
)
def test_errors_in_the_log_are_found(text: str, what: str) -> None:
    error = report(text)

    assert error is not None
    assert error.what == what


@pytest.mark.parametrize(
    "text", ["[WARN] [arm]: warm\n", "an ERROR in words\n", "Exception ignored in: <f>\n" + RAISED]
)
def test_other_lines_are_no_errors(text: str) -> None:
    assert report(text) is None


TWICE = SHUT_DOWN.replace("failed to shutdown: rcl_shutdown already called on the given context", "").replace(
    "rclpy._rclpy_pybind11.RCLError: ", "RuntimeError: Context must be initialized before it can be shutdown"
)


CANCELLED = CTRL_C.replace("KeyboardInterrupt", "asyncio.exceptions.CancelledError") + AGAIN + CTRL_C


@pytest.mark.parametrize("text", [CANCELLED, CTRL_C, CTRL_C + AGAIN + SHUT_DOWN, SHUT_DOWN, TWICE])
def test_a_program_that_ctrl_c_ends_has_no_error_when_it_is_stopped(text: str) -> None:
    assert report(text, stopping=True) is None
    assert report(text) is not None, "nobody stopped it"


@pytest.mark.parametrize(("text", "code"), [(CTRL_C, -2), (SHUT_DOWN, 1)])
def test_a_program_of_a_launch_that_ctrl_c_ends_has_no_error_when_the_launch_is_stopped(text: str, code: int) -> None:
    lines = "".join(f"[arm-1] {line}\n" for line in text.splitlines())
    died = f"[ERROR] [arm-1]: process has died [pid 5, exit code {code}]\n"

    assert report(lines + died, stopping=True) is None
    assert report(f"[ERROR] [arm-1]: process has died [pid 5, exit code {code}]\n") is not None, "nobody stopped it"
    assert report(RAISED + died, stopping=True) is not None, "it fails by itself"


@pytest.mark.parametrize(
    "disturbed",
    [
        SHUT_DOWN.replace("rclpy._rclpy", "[INFO] [arm]: bye\nrclpy._rclpy"),
        SHUT_DOWN.replace("rclpy._rclpy", "2026-01-01 10:00:00.000 [RTPS_TRANSPORT Error] full\nrclpy._rclpy"),
        SHUT_DOWN.replace(".RCLError", ".2026-01-01 10:00:00.000 [RTPS_TRANSPORT Error] full\nRCLError"),
        "50 %" + SHUT_DOWN,
        "Exception ignored in: <f>\n" + RAISED + SHUT_DOWN,
    ],
    ids=["a log's line", "the middleware's line", "in the last line", "after half a line", "after an ignored one"],
)
def test_however_the_traceback_of_ctrl_c_comes_out_it_is_no_error(disturbed: str) -> None:
    log = NodeLog()
    log.add(disturbed, stopping=True)

    assert log.was_interrupted
    assert describe("arm", log, "") is None


def test_a_line_of_the_middleware_in_a_traceback_does_not_hide_its_error() -> None:
    error = report(RAISED.replace("ValueError", "2026-01-01 [RTPS Error] full\nValueError"))

    assert error is not None
    assert error.what == "ValueError: no grip."


def test_an_exception_while_a_program_is_stopped_is_an_error() -> None:
    error = report(CTRL_C + AGAIN + RAISED, stopping=True)

    assert error is not None
    assert error.what == "ValueError: no grip."


def test_a_syntax_error_has_the_path_and_the_line_of_its_cell(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "arm.py"
    file.write_text("import math\n\n\n# %%node arm (line 2)\nx = (\n")
    printed = [f'  File "{file}", line 5', "    x = (", "SyntaxError: '(' was never closed"]
    assert list(ReaderFrames().shown(printed)) == ['  File "arm.py", line 3', *printed[1:]]


def test_exit_codes() -> None:
    assert how_it_ended(-11) == "was ended by signal 11 (SIGSEGV)."
    assert ended_badly(3, stopped=False)
    assert ended_badly(-11, stopped=True)
    assert not ended_badly(-2, stopped=True)
    assert not ended_badly(1, stopped=True, interrupted=True)
    assert not ended_badly(0, stopped=False)


SERVICE = """# %%node arm


def main():
    node.create_service(AddTwoInts, "add", add)
    rclpy.spin(node)


def add(request, response):
    response.sum = 2
"""
REFUSED = """Traceback (most recent call last):
  File "FILE", line 6, in main
    rclpy.spin(node)
  File "/lib/rclpy/executors.py", line 450, in _execute_service
    srv.send_response(response, header)
  File "/lib/rclpy/service.py", line 75, in send_response
    raise TypeError()
TypeError
"""


def test_a_callback_that_returns_nothing_is_named_with_its_line_and_what_to_do(tmp_path: Path) -> None:
    file = tmp_path / "arm.py"
    file.write_text(SERVICE)
    log = NodeLog()
    log.add(REFUSED.replace("FILE", str(file)))

    error = describe("arm", log, "ended with exit code 1.", files=[str(file)])

    assert error is not None
    assert (error.file, error.line) == ("arm.py", 9)
    assert error.what.startswith("`add` can end without returning the service's response (TypeError). It ended")
    assert error.advice.endswith("end each way through it with `return response`.")


def test_a_value_that_is_no_message_is_named_with_what_was_expected() -> None:
    text = 'python: twist.c:9: twist__convert_from_py: Assertion `strncmp("m.msg._twist.Twist", 3)\' failed.\n'
    error = report(text, ended="was ended by signal 6 (SIGABRT).")

    assert error is not None
    assert error.what.startswith("something else was sent where a `Twist` belongs. It was ended")
