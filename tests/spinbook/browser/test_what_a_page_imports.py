"""What a page imports is in its archives, and needs neither a sandbox nor a terminal, which a page does not have."""

from __future__ import annotations

import subprocess
import sys

import pytest

from spinbook.browser.archives import check_archive, ros_archive

CHECKED = (
    "grader.checking.judge",
    "grader.submission.code",
    "grader.report.facts",
    "grader.report.feedback",
    "grader.report.feedback_plot",
    "spinbook.browser.in_page.check",
)


@pytest.fixture(scope="module")
def archives(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """The paths of check.zip and ros.zip: a page that checks searches them in this order."""
    folder = tmp_path_factory.mktemp("page")
    files = {folder / "check.zip": check_archive({}), folder / "ros.zip": ros_archive()}
    for file, content in files.items():
        file.write_bytes(content)
    return [str(file) for file in files]


def printed(archives: list[str], code: str) -> str:
    """Return what code prints that can import the archives and Python's own library, and nothing else."""
    command = [sys.executable, "-I", "-S", "-c", f"import sys; sys.path[:0] = {archives!r}\n{code}"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_a_check_and_what_is_shown_of_it_need_nothing_but_the_archives(archives: list[str]) -> None:
    code = f"import rcl_python; rcl_python.install(); sys.modules['resource'] = None; import {', '.join(CHECKED)}"
    assert printed(archives, f"{code}; print(grader.checking.judge.__file__)").startswith(archives[0])


def test_what_the_editor_says_needs_nothing_but_the_archive(archives: list[str]) -> None:
    code = "from spinbook.browser.in_page import advice as it; print(it.__file__, it.problems('if x'))"
    said = printed(archives[1:], code)
    assert said.startswith(archives[1])
    assert "expected ':'" in said
