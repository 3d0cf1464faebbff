"""What readers write into a page is shown, marked and never lost: in a real Chromium."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from browser import Opened, choose, code_in, open_editor, opened, write_code
from playwright.sync_api import Browser, BrowserContext, Locator, Page, expect

from spinbook.browser.files import can_run

pytestmark = pytest.mark.skipif(not can_run(), reason="set-up could not fetch Pyodide from npm")

#: Python, which checks edited code, need not start here.
WITHOUT_PYTHON = "delete WebAssembly.Suspending;"
STARTER = "Edit and check the starter here"
#: No character fits into the storage any more, or it is forbidden: what a browser does then.
FULL = "Storage.prototype.setItem = () => { throw new DOMException('full', 'QuotaExceededError'); }; 0"
FORBIDDEN = (
    "Object.defineProperty(window, 'localStorage', { get: () => { throw new DOMException('no', 'SecurityError'); } });"
)


@pytest.fixture(scope="module")
def shown(reader: BrowserContext, address: str) -> Iterator[Opened]:
    with opened(reader, f"{address}/chapters/01-talk.html") as window:
        window.page.add_init_script(WITHOUT_PYTHON)
        yield window


@pytest.fixture(autouse=True)
def fresh(shown: Opened, address: str) -> None:
    """Each test begins with an empty storage."""
    shown.show(f"{address}/glossary.html")
    shown.page.evaluate("localStorage.clear()")
    shown.show(f"{address}/chapters/01-talk.html")


def write(page: Page, old: str, new: str) -> Locator:
    """Change the node's code as a reader does; return its cell."""
    cell = page.locator(".cell-node")
    write_code(cell, code_in(cell).replace(old, new))
    return cell


def code(page: Page) -> str:
    return code_in(page.locator(".cell-node"))


def test_an_edit_is_shown_after_a_reload_with_what_differs(shown: Opened) -> None:
    page = shown.page
    cell = write(page, "number", "edited")
    page.reload()
    expect(cell.locator(".edited")).to_have_text("edited")
    expect(cell.get_by_role("textbox")).to_contain_text("edited {self.count}")
    choose(page.locator(".cell-node"), "Changes")
    lines = cell.get_by_role("group", name="Lines that differ")
    assert [line[0] for line in lines.inner_text().splitlines() if line[:1] in ("+", "-")] == ["-", "+"]
    assert shown.violations() == []
    with page.expect_download() as download:
        choose(page.locator(".cell-node"), "Download talker.py")
    assert "edited {self.count}" in Path(download.value.path()).read_text()

    choose(page.locator(".cell-node"), "Reset")
    expect(cell.locator(".edited")).to_be_hidden()
    assert "edited" not in code(page)
    page.get_by_role("button", name="Undo the change of talker").click()
    assert "edited" in code(page)
    choose(page.locator(".cell-node"), "Reset")
    page.reload()
    choose(page.locator(".cell-node"), "Changes")
    cell.get_by_role("combobox").select_option(index=1)
    page.get_by_role("button", name="Use that version of talker").click()
    assert "edited" in code(page)
    written = code(page)
    for typed, becomes in (("(", f"({written})"), ("x", "x")):
        open_editor(cell).press("Control+a")
        page.keyboard.press(typed)
        assert code(page) == becomes
    assert shown.faults == []


def test_a_course_that_has_changed_under_a_draft_says_so_and_keeps_both(shown: Opened) -> None:
    page = shown.page
    cell = write(page, "number", "edited")
    (key,) = page.evaluate("Object.keys(localStorage).filter(key => key.startsWith('code:'))")
    draft = json.loads(page.evaluate("key => localStorage[key]", key))
    draft["original"] = draft["original"].replace("two", "two in the old course")
    page.evaluate(
        "([key, text]) => { localStorage[key] = text; localStorage[key + '-gone'] = text; }", [key, json.dumps(draft)]
    )
    page.reload()

    expect(cell).to_contain_text("The course has a new version of this code.")
    assert "edited" in code(page)
    expect(page.locator(".homeless")).to_contain_text("no longer has a cell that you have edited (talker-gone)")
    choose(page.locator(".cell-node"), "Changes")
    cell.get_by_role("combobox").select_option(label="the course's earlier code")
    assert "edited" in cell.locator(".diff-new").inner_text()
    page.get_by_role("button", name="Use the course's new talker").click()
    assert "edited" not in code(page)
    page.get_by_role("button", name="Undo the change of talker").click()
    assert "edited" in code(page)


def test_a_draft_follows_its_cell_when_others_are_added_above(shown: Opened) -> None:
    page = shown.page
    page.evaluate("""() => {
      const written = document.querySelector('.cell-snippet .cell_input pre').textContent;
      const draft = { original: written, text: written + '# mine', versions: [] };
      localStorage['code:' + location.pathname + '#cell 17'] = JSON.stringify(draft);
    }""")
    page.reload()
    expect(page.locator(".cell-snippet").first.get_by_role("textbox")).to_contain_text("# mine")
    assert page.locator(".homeless").count() == 0


def test_two_tabs_never_overwrite_each_other_in_silence(shown: Opened) -> None:
    page = shown.page
    other = page.context.new_page()
    try:
        other.goto(page.url)
        expect(open_editor(other.locator(".cell-node"))).to_be_focused()
        write(page, "number", "first tab")
        expect(other.locator(".cell-node")).to_contain_text("Changed in another tab.")
        expect(other.locator(".cell-node .cm-content")).to_contain_text("first tab")
        # A tab that sleeps does not hear of it.
        other.evaluate("addEventListener('storage', (event) => event.stopImmediatePropagation(), true)")
        page.evaluate("addEventListener('storage', (event) => event.stopImmediatePropagation(), true)")
        (key,) = page.evaluate("Object.keys(localStorage).filter(key => key.startsWith('code:'))")
        stored = json.loads(page.evaluate("key => localStorage[key]", key))
        stored["text"] = stored["text"].replace("first tab", "while asleep")
        page.evaluate("([key, text]) => localStorage.setItem(key, text)", [key, json.dumps(stored)])
        cell = write(page, "first tab", "again")
        expect(cell).to_contain_text("Another tab had changed this code, too")
        choose(page.locator(".cell-node"), "Changes")
        expect(cell.get_by_role("combobox")).to_contain_text("from another tab")
    finally:
        other.close()


@pytest.mark.parametrize(
    ("how", "says"), [(FULL, "storage for this site is full"), (FORBIDDEN, "does not let the page store")]
)
def test_a_browser_that_can_not_store_is_reported(shown: Opened, how: str, says: str) -> None:
    shown.page.evaluate(how)
    cell = write(shown.page, "number", "edited")
    expect(cell).to_contain_text(says)
    write(shown.page, "edited", "number")
    expect(cell).not_to_contain_text(says)


def test_without_codemirror_code_is_edited_in_a_plain_field(browser: Browser, address: str) -> None:
    # A window of its own: this one's cache has CodeMirror.
    with opened(browser, f"{address}/chapters/01-talk.html") as window:
        window.page.route("**/run/codemirror.js*", lambda route: route.abort())
        cell = window.page.locator(".cell-node")
        cell.locator("pre").first.click(position={"x": 40, "y": 20})
        cell.locator("textarea").fill("print('plain')\n")
        expect(cell.locator(".edited")).to_have_text("edited")
        assert window.violations() == []


def test_a_starter_with_a_draft_opens_with_it(shown: Opened, address: str) -> None:
    page = shown.page
    shown.show(f"{address}/exercises/joint_velocity.html")
    page.get_by_role("button", name=STARTER).click()
    page.get_by_label("A file to continue with").set_input_files(
        {"name": "mine.py", "mimeType": "text/x-python", "buffer": b"print('mine')\n"}
    )
    field = page.get_by_role("textbox", name=re.compile("Code of joint_velocity.py"))
    expect(field).to_have_text("print('mine')")
    page.get_by_role("button", name="Undo the change of joint_velocity.py").click()
    expect(field).to_contain_text("import")
    page.get_by_role("button", name="Changes in joint_velocity.py").click()
    page.get_by_role("combobox").select_option(index=1)
    page.get_by_role("button", name="Use that version of joint_velocity.py").click()
    page.reload()
    expect(field).to_have_text("print('mine')")
    assert shown.violations() == []
    assert shown.faults == []
