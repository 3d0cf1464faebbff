"""A new student, with the handout's zip: unpacks it, opens the notebook in JupyterLab, fails, fixes, submits."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
import zipfile
from collections.abc import Sequence
from pathlib import Path

import pytest
from course_folder import CourseFolder
from playwright.sync_api import Browser, expect

from grader.submission.upload import unpack
from handout.conftest import CHAPTER, HandedOut, copy_course, hand_out, solution
from handout.jupyter_lab import DEADLINE_MS, HERE, a_new_terminal, jupyter_lab, opened_notebook

UPLOAD = "joint_velocity-submission.zip"


def unpacked(handed_out: HandedOut, place: Path) -> Path:
    """The student's folder."""
    with zipfile.ZipFile(handed_out.archive) as archive:
        archive.extractall(place)
    return place / handed_out.folder.name


def works_through(
    browser: Browser,
    folder: Path,
    name: str,
    pictures: Path,
    command: Sequence[str] = HERE,
    timeout_ms: int = DEADLINE_MS,
) -> None:
    """Open the notebook, run all, fail the check with the starter, write the solution, pass, submit, save.

    Pictures of each step are saved in `pictures`; `timeout_ms` is for running all cells.
    """
    with jupyter_lab(folder, pictures / "state", command) as url, opened_notebook(browser, url, name) as notebook:
        notebook.page.screenshot(path=pictures / "1-opened.png")
        notebook.run_all()
        check = notebook.cell("%check joint_velocity").locator(".spinbook-check")
        check.wait_for(state="attached", timeout=timeout_ms)
        expect(check).to_contain_text(re.compile(r"\b0 of \d+ public checks, 0 of \d+ points"))
        expect(check.locator(".sb-failed")).to_have_count(1)
        for step in ("Where to look", "What to do"):
            unfolds = check.locator("details").filter(has_text=step).first
            expect(unfolds.locator(":scope > :not(summary)").first).to_be_hidden()
            unfolds.locator("summary").click()
            expect(unfolds.locator(":scope > :not(summary)").first).to_be_visible()
        check.screenshot(path=pictures / "2-starter.png")
        finding = check.locator(".sb-failed").first
        assert finding.evaluate("it => getComputedStyle(it).textAlign") in ("left", "start"), (
            "JupyterLab has its own rules"
        )

        notebook.type_into("%%node joint_velocity", f"%%node joint_velocity\n{solution()}")
        notebook.run("%%node joint_velocity")
        notebook.run("%check joint_velocity")
        expect(check).to_contain_text(
            re.compile(r"\b(\d+) of \1 public checks, (\d+) of \2 points"), timeout=DEADLINE_MS
        )
        expect(check.locator(".sb-failed, .sb-blocked")).to_have_count(0)
        check.screenshot(path=pictures / "3-solved.png")

        notebook.add_below("%check joint_velocity", "%submit joint_velocity --student 'Ada L'")
        submit = notebook.cell("%submit joint_velocity --student")
        expect(submit).to_contain_text(f"Upload this file: {UPLOAD}", timeout=DEADLINE_MS)
        submit.screenshot(path=pictures / "4-handed-in.png")
        notebook.save()


@pytest.mark.soak
@pytest.mark.timeout(600)
def test_from_the_zip_to_full_marks(
    browser: Browser, small_course: CourseFolder, small: HandedOut, tmp_path: Path
) -> None:
    folder = unpacked(small, tmp_path)

    works_through(browser, folder, "01-small.ipynb", tmp_path)

    upload = unpack((folder / UPLOAD).read_bytes())
    assert (upload.faults, upload.record["student"]) == ((), "Ada L")
    saved = folder / "01-small.ipynb"
    assert "answer.velocity.append" in saved.read_text(encoding="utf-8"), "the notebook was saved"

    # As one file, and in a folder with a class's submissions.
    single = small_course.spinbook("grade", "joint_velocity", str(shutil.copy(folder / UPLOAD, tmp_path / "ada.zip")))
    assert single.returncode == 0, single.stdout + single.stderr
    assert "100 of 100 points" in single.stdout
    handed_in, out = tmp_path / "submissions" / "ada", tmp_path / "out"
    handed_in.mkdir(parents=True)
    shutil.copy(folder / UPLOAD, handed_in)
    graded = small_course.spinbook("grade", "joint_velocity", str(handed_in.parent), "--out", str(out))
    assert graded.returncode == 0, graded.stdout + graded.stderr
    assert re.search(r"\bada\b.*\b100\b", graded.stdout), graded.stdout


def lines_of(readme: str, step: str) -> list[str]:
    """Return the commands of a step, as written there."""
    section = readme.split(f"## {step}")[1].split("\n## ")[0]
    fences = re.findall(r"```bash\n(.*?)```", section, re.DOTALL)
    return [line.strip() for fence in fences for line in fence.strip().split("\n")]


@pytest.mark.soak
@pytest.mark.timeout(1800)
def test_the_readme_followed_word_by_word_on_a_fresh_machine(browser: Browser, tmp_path: Path) -> None:
    course = copy_course(tmp_path / "author")
    folder = unpacked(hand_out(course), tmp_path / "student")
    readme = (folder / "README.md").read_text(encoding="utf-8")
    # An empty home, and the Python that the machine has.
    base = os.fspath(Path(sys.base_prefix, "bin"))
    fresh = {**a_new_terminal(), "HOME": os.fspath(tmp_path / "home"), "PATH": f"{base}:{os.defpath}"}
    (tmp_path / "home").mkdir()

    for line in lines_of(readme, "Step 1"):
        subprocess.run(line, shell=True, cwd=folder, env=fresh, check=True, timeout=900)
    install_lab, open_lab = lines_of(readme, "Step 2")
    subprocess.run(install_lab, shell=True, cwd=folder, env=fresh, check=True, timeout=900)
    pictures = Path(os.environ.get("SPINBOOK_PICTURES", tmp_path / "pictures"))
    pictures.mkdir(exist_ok=True)
    notebook = CHAPTER.replace(".md", ".ipynb")
    works_through(browser, folder, notebook, pictures, shlex.split(open_lab), 600_000)

    (folder / UPLOAD).unlink()
    [submit] = lines_of(readme, "Step 3")
    subprocess.run(submit, shell=True, cwd=folder, env=fresh, check=True, timeout=280, stdin=subprocess.DEVNULL)
    graded = course.spinbook("grade", "joint_velocity", str(folder / UPLOAD))
    assert "100 of 100 points" in graded.stdout, graded.stdout + graded.stderr
