"""`%submit` submits the cell as it was run last, even if the notebook has not been saved."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from notebook_kernel import Kernel

from grader.submission.upload import unpack

ROOT = Path(__file__).parents[3]
CODE = "import rclpy\nrclpy.init()\nrclpy.spin(rclpy.create_node('joint_velocity'))\n"


@pytest.fixture(scope="module")
def kernel(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Kernel]:
    folder = tmp_path_factory.mktemp("student")
    for part in ("exercises", "solutions"):
        shutil.copytree(ROOT / part / "joint_velocity", folder / part / "joint_velocity")
    kernel = Kernel(folder)
    yield kernel
    kernel.shut_down()


def test_the_cell_is_checked_and_handed_in_as_it_was_run(kernel: Kernel) -> None:
    kernel.run(f"%%node joint_velocity --seconds 0.1\n{CODE}")
    shown = kernel.run("%submit joint_velocity --student 'Ada L'")
    assert not shown.error, shown.error
    assert "Handing in: the cell %%node joint_velocity as you ran it at " in shown.text
    assert "This is a self-check, not your grade." in shown.text, shown.text
    assert "Upload this file: joint_velocity-submission.zip" in shown.text
    upload = unpack((kernel.folder / "joint_velocity-submission.zip").read_bytes())
    assert upload.faults == ()
    assert upload.files["joint_velocity.py"].decode().strip() == CODE.strip()
    assert (upload.record["student"], upload.record["self_check"]["score"]) == ("Ada L", 0)


def test_when_it_is_stopped_it_says_whether_anything_was_handed_in(kernel: Kernel) -> None:
    upload = kernel.folder / "joint_velocity-submission.zip"
    upload.unlink()
    shown = kernel.run("%submit joint_velocity", kernel.pressing_stop(lambda shown: "Handing in" in shown.text))
    if upload.exists():
        assert "No self-check: It was interrupted." in shown.text
        assert "To wait longer: %submit joint_velocity --seconds 240" in shown.text
    else:
        assert shown.error.startswith("Nothing was handed in: it was stopped before the file was written."), shown


@pytest.mark.parametrize(
    ("command", "answer"),
    [
        (
            "%submit",
            "Nothing was handed in: it was stopped before the file was written. Run %submit joint_velocity again.",
        ),
        ("%check", "The check was interrupted, so there is no result."),
    ],
)
def test_stop_before_anything_was_started_is_answered_with_a_sentence(
    kernel: Kernel, command: str, answer: str
) -> None:
    kernel.run("import signal; from spinbook.kernel import check_cell; require = check_cell.require_middleware")
    kernel.run("check_cell.require_middleware = lambda say: signal.raise_signal(signal.SIGINT)")
    error = kernel.run(f"{command} joint_velocity").error
    kernel.run("check_cell.require_middleware = require")
    assert error == answer
