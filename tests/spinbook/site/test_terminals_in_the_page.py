"""Terminals, launches and versions of a node in a page: each its own process, output and Stop. In a real Chromium."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from browser import Opened, opened
from playwright.sync_api import BrowserContext, Locator, expect

from spinbook.browser.files import can_run

pytestmark = pytest.mark.skipif(not can_run(), reason="set-up could not fetch Pyodide from npm")

#: Pyodide starts in a few seconds; on a busy machine, in many.
DEADLINE_MS = 120_000
_COVERS = """([head, wanted]) => {
  const bar = document.querySelector('.running');
  return (head.getBoundingClientRect().bottom > bar.getBoundingClientRect().top) === wanted;
}"""


@pytest.fixture(scope="module")
def shown(reader: BrowserContext, programs: str) -> Iterator[Opened]:
    """The page of one chapter, for all tests."""
    with opened(reader, f"{programs}/chapters/terminals.html") as page:
        yield page


def cell(shown: Opened, number: int) -> Locator:
    """The chapter's block with this number, from 1."""
    return shown.page.locator("main .cell").nth(number - 1)


def run(shown: Opened, number: int) -> Locator:
    """Press Run; return the block's output, once that of an earlier run is gone."""
    place = cell(shown, number)
    output = place.get_by_role("log")
    earlier = output.element_handles()
    place.locator(".run-button", has_text="Run").filter(has_not_text="all").click()
    for each in earlier:
        each.wait_for_element_state("hidden")
    return output


def stop_all(shown: Opened) -> None:
    shown.page.get_by_role("button", name="Stop all nodes").click()
    expect(shown.page.get_by_role("region", name="Running nodes")).to_be_hidden(timeout=DEADLINE_MS)


def at_the_end(shown: Opened, number: int) -> Locator:
    """Scroll a block's head to the window's lower end."""
    head = cell(shown, number).locator(".cell-head")
    head.evaluate("head => head.scrollIntoView({ block: 'end', behavior: 'instant' })")
    return head


def waits_until(shown: Opened, head: Locator, is_covered: bool) -> None:
    """Wait until the bar covers a part of a block's head, or none of it: while the page grows, that changes."""
    shown.page.wait_for_function(_COVERS, arg=[head.element_handle(), is_covered])


def test_ros2_run_starts_the_newest_version_above(shown: Opened) -> None:
    expect(run(shown, 3)).to_contain_text("[talker]: version two", timeout=DEADLINE_MS)
    expect(cell(shown, 3).get_by_role("status")).to_have_text("talker runs.")
    expect(cell(shown, 3).get_by_role("button", name="Ctrl-C")).to_be_visible()
    expect(run(shown, 1)).to_contain_text("[talker]: version one", timeout=DEADLINE_MS)


def test_a_newer_version_in_another_file_replaces_the_running_one(shown: Opened) -> None:
    newer = run(shown, 9)

    expect(newer).to_contain_text("(replaces talker, the earlier version of this node)", timeout=DEADLINE_MS)
    expect(newer).to_contain_text("[talker]: version three", timeout=DEADLINE_MS)
    expect(cell(shown, 1).get_by_role("status")).to_have_text("talker ended with 0.")
    stop_all(shown)


def test_two_terminals_at_once_have_their_own_output_and_stop(shown: Opened) -> None:
    bar = shown.page.get_by_role("region", name="Running nodes").get_by_role("listitem")
    publishing = run(shown, 4)
    expect(publishing).to_contain_text("publishing #2", timeout=DEADLINE_MS)
    echoing = run(shown, 5)
    expect(echoing).to_contain_text("data: 5", timeout=DEADLINE_MS)
    expect(cell(shown, 5).get_by_role("status")).to_contain_text("all that the chapter shows", timeout=DEADLINE_MS)
    expect(bar).to_have_text(["ros2 topic pubStop"])
    assert "publishing" not in echoing.inner_text()
    assert "---" not in publishing.inner_text()
    assert "does not appear to be published" not in echoing.inner_text()
    publishing.press("Control+c")
    expect(bar).to_have_count(0, timeout=DEADLINE_MS)
    expect(cell(shown, 4).get_by_role("status")).to_have_text("Ended by Ctrl-C.")
    assert shown.faults == []


def test_a_launch_is_one_entry_and_bad_words_leave_it_alone(shown: Opened) -> None:
    bar = shown.page.get_by_role("region", name="Running nodes").get_by_role("listitem")
    expect(run(shown, 7)).to_contain_text("Run talkers.launch.py above first.", timeout=DEADLINE_MS)
    expect(run(shown, 6)).to_contain_text("Wrote", timeout=DEADLINE_MS)
    launched = run(shown, 7)
    for name in ("[a]", "[b]"):
        expect(launched).to_contain_text(f"{name}: version two", timeout=DEADLINE_MS)
    expect(launched).to_contain_text("a has started")
    expect(bar).to_have_text(["talkersStop"])

    expect(run(shown, 8)).to_contain_text("sideways", timeout=DEADLINE_MS)
    expect(cell(shown, 7).get_by_role("status")).to_have_text("talkers runs.")
    expect(bar).to_have_text(["talkersStop"])
    shown.page.get_by_role("button", name="Stop talkers").click()
    expect(cell(shown, 7).get_by_role("status")).to_have_text("talkers ended with 0.", timeout=DEADLINE_MS)
    expect(bar).to_have_count(0)
    assert shown.violations() == []
    assert shown.faults == []


@pytest.mark.parametrize(("number", "line"), [(4, "publishing #1"), (7, "[b]: version two")])
def test_run_pressed_again_begins_anew_unless_it_is_starting(shown: Opened, number: int, line: str) -> None:
    expect(run(shown, 6)).to_contain_text("Wrote", timeout=DEADLINE_MS)
    pressed = cell(shown, number).locator(".run-button", has_text="Run").filter(has_not_text="all")
    pressed.dblclick()
    expect(cell(shown, number).get_by_role("log")).to_contain_text(line, timeout=DEADLINE_MS)
    for _ in ("while it shows its output", "right after that"):
        expect(run(shown, number)).to_contain_text(line, timeout=DEADLINE_MS)
    stop_all(shown)


def test_run_answers_in_the_head_of_its_block_and_the_bar_does_not_cover_it(shown: Opened) -> None:
    for number, version, width in ((1, "one", 1280), (2, "two", 390)):  # the bar is there only when the second is run
        shown.page.set_viewport_size({"width": width, "height": 844})
        head = at_the_end(shown, number)
        run(shown, number)
        expect(head.get_by_role("status")).not_to_be_empty()
        expect(head.locator(".run-last")).to_have_text(f"[INFO] [talker]: version {version}", timeout=DEADLINE_MS)
        expect(head.get_by_role("status")).to_have_text("talker runs.")
        waits_until(shown, head, is_covered=False)
        assert not shown.scrolls_sideways()
    head.get_by_role("button", name="Ctrl-C").click()
    expect(head.get_by_role("status")).to_have_text("talker ended with 0.", timeout=DEADLINE_MS)


def test_output_above_moves_no_head_behind_the_bar_unless_the_reader_scrolls(shown: Opened) -> None:
    def waits_for_another_line() -> None:
        expect(published.nth(published.count())).to_be_attached(timeout=DEADLINE_MS)

    shown.page.set_viewport_size({"width": 390, "height": 844})
    published = run(shown, 4).locator("span")
    expect(published.first).to_be_attached(timeout=DEADLINE_MS)  # otherwise, echo can't know the type
    head = at_the_end(shown, 5)
    expect(run(shown, 5)).to_contain_text("data: 5", timeout=DEADLINE_MS)
    waits_for_another_line()
    waits_until(shown, head, is_covered=False)

    shown.page.mouse.wheel(0, -100)
    waits_until(shown, head, is_covered=True)
    waits_for_another_line()
    # The page is laid out with that line, and has looked at it.
    shown.page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    waits_until(shown, head, is_covered=True)
