"""What Check in a page imports needs neither a sandbox nor a terminal, which a page does not have."""

from __future__ import annotations

import subprocess
import sys

ABSENT = ("grader.grading", "grader.sandbox", "grader.workers", "rich", "numpy", "matplotlib", "resource")
SHOWN = ("grader.report.checks", "grader.report.facts", "grader.report.feedback", "grader.report.feedback_plot")


def test_what_is_shown_of_a_check_imports_without_a_sandbox() -> None:
    code = f"import sys; sys.modules.update(dict.fromkeys({ABSENT!r})); import {', '.join(SHOWN)}"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
