"""A student's hour with Week 3 in a fresh browser, from the first Run to the grade.

SPINBOOK_SCREENSHOTS names a folder for pictures of each step.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import pytest
from browser import Opened, choose, code_in, opened, write_code
from playwright.sync_api import Browser, Page, expect
from small_course import ROOT, served

from grader.exercise import load
from grader.exercise.mistakes import mistake_of
from grader.grading import grade_submission
from grader.submission import read

EXERCISE = ROOT / "exercises" / "joint_velocity"
SOLUTIONS = ROOT / "solutions" / "joint_velocity"
MISTAKES = ("wrong_topic", "degrees", "sign_turned_round", "publishes_on_the_first_message", "traceback_on_ctrl_c")
DEADLINE_MS = 180_000
WIDTHS = (1280, 390)

pytestmark = [pytest.mark.soak, pytest.mark.timeout(1800)]


def in_both_colours(page: Page) -> Iterator[str]:
    """Show the page in the dark, then in the light."""
    for colours in ("dark", "light"):
        page.evaluate("colours => { document.documentElement.dataset.colours = colours; }", colours)
        yield colours


def picture(page: Page, name: str) -> None:
    if folder := os.environ.get("SPINBOOK_SCREENSHOTS"):
        assert page.viewport_size
        for colours in in_both_colours(page):
            page.screenshot(path=Path(folder, f"{name}-{page.viewport_size['width']}-{colours}.png"))


def press(page: Page, name: str) -> None:
    page.get_by_role("button", name=name, exact=True).click()


def change(page: Page, file: str, old: str, new: str) -> None:
    field = page.get_by_role("textbox", name=f"Code of {file}. ")
    cell = page.locator(".cell", has=field)
    assert old in code_in(cell)
    write_code(cell, code_in(cell).replace(old, new))


def output(name: str) -> str:
    return f'.ran [role=log][aria-label="Output of {name}"]'


def says(page: Page, name: str, text: str) -> None:
    expect(page.locator(output(name))).to_contain_text(text, timeout=DEADLINE_MS)


def clean(shown: Opened) -> None:
    for colours in in_both_colours(shown.page):
        found = shown.violations()
        assert found == [], (colours, found)
    assert shown.faults == []
    assert not shown.scrolls_sideways()


def the_chapter(shown: Opened) -> None:
    """Run two nodes, edit one, break one, stop one; the edit is there after a reload."""
    page = shown.page
    press(page, "Whole chapter")
    press(page, "Run left_toe.py")
    says(page, "left_toe", "I publish 102.0 N")
    press(page, "Run balance_controller.py")
    says(page, "balance_controller", "I hear")
    press(page, "Node graph")
    expect(page.locator(".graph-panel svg")).to_contain_text("/left_foot/toe", timeout=DEADLINE_MS)
    clean(shown)
    for name in ("left_toe", "balance_controller"):
        expect(page.get_by_role("button", name=f"Stop {name}", exact=True)).to_be_in_viewport(ratio=1)
    picture(page, "1-two-nodes")
    press(page, "Node graph")

    change(page, "left_toe.py", "self.force += 1.0", "self.force += 10.5")
    press(page, "Run left_toe.py")
    says(page, "left_toe", "I publish 110.5 N")
    change(page, "left_toe.py", "self.create_timer(", "self.creat_timer(")
    press(page, "Run left_toe.py")
    says(page, "left_toe", "AttributeError")
    picture(page, "2-broken")
    press(page, "Stop balance_controller")
    expect(page.get_by_role("region", name="Running nodes")).to_be_hidden(timeout=DEADLINE_MS)
    page.reload()
    press(page, "Run left_toe.py")
    says(page, "left_toe", "AttributeError")
    choose(page.locator(".cell-node").first, "Reset")
    expect(page.locator(".cell-node").first.locator(".cell_output")).to_be_visible()


def the_exercise(shown: Opened, downloads: Path) -> Path:
    """Try five typical mistakes, then the solution; the draft survives a reload. Return the downloaded file."""
    page = shown.page
    press(page, "Edit and check the starter here")
    for name in MISTAKES:
        file = downloads / f"{name}.py"
        file.write_text(f"# {name}\n{mistake_of(load(EXERCISE), name).source}")
        check(page, file)
        expect(page.locator(".check-failed").first).to_be_visible()
        if name == "degrees":
            clean(shown)
            picture(page, "3-degrees")
    check(page, SOLUTIONS / "solution.py")
    expect(page.locator(".check-total")).to_contain_text("9 of 9 public checks, 37 of 37 points", timeout=DEADLINE_MS)
    picture(page, "4-solved")
    page.reload()
    press(page, "Edit and check the starter here")
    draft = page.get_by_role("textbox", name="Code of joint_velocity.py")
    expect(draft).to_contain_text((SOLUTIONS / "solution.py").read_text().splitlines()[0])
    picture(page, "5-draft-found-again")
    with page.expect_download() as download:
        press(page, "Download your joint_velocity.py")
    file = downloads / download.value.suggested_filename
    download.value.save_as(file)
    return file


def check(page: Page, file: Path) -> None:
    page.get_by_label("A file to continue with").set_input_files(file)
    expect(page.get_by_role("textbox", name="Code of joint_velocity.py")).to_contain_text(
        file.read_text().splitlines()[0]
    )
    page.locator(".check-result").evaluate("place => place.replaceChildren()")
    press(page, "Check joint_velocity.py")
    expect(page.locator(".check-total")).to_be_in_viewport(timeout=DEADLINE_MS)


@pytest.mark.parametrize("width", WIDTHS)
def test_a_students_hour(real_course: Path, browser: Browser, tmp_path: Path, width: int) -> None:
    with served(real_course / "site") as address:
        with opened(browser, f"{address}/chapters/03-nodes-and-topics.html", width=width) as shown:
            the_chapter(shown)
        with opened(browser, f"{address}/exercises/joint_velocity.html", width=width) as shown:
            file = the_exercise(shown, tmp_path)
    exercise = load(EXERCISE)
    grade = grade_submission(exercise, read(str(file), exercise))
    assert {verdict.status for verdict in grade.verdicts} == {"passed"}
