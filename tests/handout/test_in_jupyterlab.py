"""A new student, with the handout's zip: unpacks it, opens the notebook in JupyterLab, fails, mends, hands in."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

from course_folder import CourseFolder
from playwright.sync_api import Browser, expect

from handout.conftest import HandedOut, solution
from handout.jupyter_lab import LONG, jupyter_lab, opened_notebook


def test_from_the_zip_to_full_marks(
    browser: Browser, small_course: CourseFolder, small: HandedOut, tmp_path: Path
) -> None:
    with zipfile.ZipFile(small.archive) as archive:
        archive.extractall(tmp_path)
    folder = tmp_path / small.folder.name

    with jupyter_lab(folder, tmp_path / "state") as url, opened_notebook(browser, url, "01-small.ipynb") as notebook:
        notebook.run_all()
        check = notebook.cell("%check joint_velocity").locator(".spinbook-check")
        expect(check).to_contain_text(re.compile(r"\b0 of \d+ public checks, 0 of \d+ points"), timeout=LONG)
        expect(check.locator(".sb-failed")).to_have_count(1)
        notebook.page.screenshot(path=tmp_path / "starter.png")
        expect(notebook.cell("%%node beeper").locator(".jp-OutputArea")).to_contain_text("[INFO] [beeper]: Beeping")

        notebook.type_into("%%node joint_velocity", f"%%node joint_velocity\n{solution()}")
        notebook.run("%%node joint_velocity")
        notebook.run("%check joint_velocity")
        expect(check).to_contain_text(re.compile(r"\b(\d+) of \1 public checks, (\d+) of \2 points"), timeout=LONG)
        expect(check.locator(".sb-failed, .sb-blocked")).to_have_count(0)
        notebook.page.screenshot(path=tmp_path / "solved.png")
        notebook.save()

    words = [sys.executable, "-m", "spinbook", "submit", "joint_velocity", "--student", "Ada"]
    submitted = subprocess.run(words, cwd=folder, capture_output=True, text=True, timeout=280)
    assert submitted.returncode == 0, submitted.stdout + submitted.stderr
    upload = shutil.copy(folder / "joint_velocity-submission.zip", tmp_path / "ada.zip")
    graded = small_course.spinbook("grade", "joint_velocity", str(upload))
    assert graded.returncode == 0, graded.stdout + graded.stderr
    assert "100 of 100 points" in graded.stdout
