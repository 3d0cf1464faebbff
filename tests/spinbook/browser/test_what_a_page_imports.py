"""What a page imports is in its archives, and needs neither a sandbox nor a terminal, which a page does not have."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from spinbook.browser.archives import ros_archive

ABSENT = ("grader.grading", "grader.sandbox", "grader.workers", "rich", "numpy", "matplotlib", "resource")
SHOWN = ("grader.report.checks", "grader.report.facts", "grader.report.feedback", "grader.report.feedback_plot")


def test_what_is_shown_of_a_check_imports_without_a_sandbox() -> None:
    code = f"import sys; sys.modules.update(dict.fromkeys({ABSENT!r})); import {', '.join(SHOWN)}"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr


def test_what_the_editor_says_needs_nothing_but_the_archive(tmp_path: Path) -> None:
    archive = tmp_path / "ros.zip"
    archive.write_bytes(ros_archive())
    code = f"import sys; sys.path.insert(0, {str(archive)!r}); from spinbook.browser.in_page import advice as it"
    code += "; print(it.__file__, it.problems('if x'))"
    done = subprocess.run([sys.executable, "-I", "-S", "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(str(archive))
    assert "expected ':'" in done.stdout
