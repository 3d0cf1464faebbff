"""The site in a real Chromium: on a phone and a desk, light and dark, served and from a folder."""

from __future__ import annotations

import gzip
import io
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Literal

import numpy as np
import pytest
from browser import Opened, choose, opened
from PIL import Image
from playwright.sync_api import Browser, Locator, expect
from small_course import SmallCourse

PAGES = [
    "index.html",
    "chapters/01-talk.html",
    "chapters/02-more.html",
    "exercises/joint_velocity.html",
    "glossary.html",
    "about.html",
    "search.html?q=publisher",
]
DEADLINE_MS = 60_000


@pytest.fixture(scope="module", params=[(1280, False), (390, True)], ids=["desk", "phone"])
def shown(request: pytest.FixtureRequest, browser: Browser, address: str) -> Iterator[Opened]:
    """A window at a desk, and one on a phone in the dark."""
    width, dark = request.param
    with opened(browser, f"{address}/{PAGES[0]}", width=width, dark=dark) as window:
        yield window


@pytest.mark.parametrize("page", PAGES)
def test_a_page_is_without_fault(shown: Opened, address: str, page: str) -> None:
    shown.show(f"{address}/{page}")
    assert shown.violations() == []
    assert not shown.scrolls_sideways()
    assert shown.faults == []


@pytest.fixture(scope="module")
def window(browser: Browser, address: str) -> Iterator[Opened]:
    with opened(browser, f"{address}/{PAGES[0]}") as shown:
        yield shown


Visit = Callable[..., Opened]


@pytest.fixture
def visit(window: Opened, address: str) -> Visit:
    """Shows a page in the window that other tests have used, too, as if nobody had been there before."""

    def show(page: str, *, width: int = 1280, height: int = 900, scheme: Literal["light", "dark"] = "light") -> Opened:
        if window.page.url.startswith(address):
            window.page.evaluate("localStorage.clear()")
        window.show("about:blank")  # a page with another fragment would not be loaded again
        window.page.set_viewport_size({"width": width, "height": height})
        window.page.emulate_media(media="screen", color_scheme=scheme, reduced_motion="no-preference")
        window.show(f"{address}/{page}")
        return window

    return show


@pytest.mark.parametrize("from_folder", [True, False])
def test_the_search_answers_while_one_types_and_forgives_and_leads_to_a_page(
    browser: Browser, built: SmallCourse, address: str, from_folder: bool
) -> None:
    start: str | Path = built.site / "chapters" / "01-talk.html" if from_folder else f"{address}/chapters/01-talk.html"
    with opened(browser, start) as shown:
        field, results = shown.page.get_by_role("searchbox"), shown.page.locator("#search-now a")
        shown.page.keyboard.press("/")
        expect(field).to_be_focused()
        for typed in ("publisher", "publishers", "publihser", "pubisher"):
            field.fill(typed)
            expect(results.first).to_be_visible(timeout=DEADLINE_MS)
            expect(shown.page.locator("#search-now")).to_contain_text("Publisher")
        if not from_folder:  # axe requests the style sheet itself, which a page from a folder may not
            assert shown.violations() == []
        shown.page.keyboard.press("ArrowDown")
        expect(results.first).to_be_focused()
        shown.page.keyboard.press("Escape")
        expect(results.first).to_be_hidden()
        field.fill("xylophone")
        expect(shown.page.locator("#search-now")).to_contain_text("No results for “xylophone”.")
        field.fill("publihsers")
        field.press("Enter")
        expect(shown.page.locator("#search-count")).to_contain_text("for “publisher”", timeout=DEADLINE_MS)
        found = shown.page.locator("#search-results li")
        expect(found.first).to_contain_text("Publisher")
        found.get_by_role("link", name="Talk", exact=True).click()
        expect(shown.page.get_by_role("heading", level=1)).to_contain_text("Talk", timeout=DEADLINE_MS)
        assert shown.faults == []


def test_a_chapter_tells_how_far_one_has_read_and_its_end_leads_back(visit: Visit) -> None:
    shown = visit("chapters/01-talk.html", height=300)
    bar, back = shown.page.locator("progress.reading"), shown.page.get_by_role("link", name="Back to top")
    assert bar.evaluate("bar => bar.value") == 0
    expect(back).not_to_be_in_viewport()
    shown.page.evaluate("scrollTo(0, document.documentElement.scrollHeight)")
    shown.page.wait_for_function("document.querySelector('progress.reading').value > 990")
    back.click()
    expect(back).not_to_be_in_viewport()


def test_the_switch_changes_colours_and_they_stay(visit: Visit, address: str) -> None:
    shown = visit("index.html")
    light = shown.page.evaluate("getComputedStyle(document.body).backgroundColor")
    shown.page.get_by_role("button", name="Dark colours").click()
    dark = shown.page.evaluate("getComputedStyle(document.body).backgroundColor")
    assert dark != light
    shown.page.goto(f"{address}/glossary.html")
    assert shown.page.evaluate("getComputedStyle(document.body).backgroundColor") == dark


def test_copying_gives_the_node_s_code(visit: Visit, built: SmallCourse, address: str) -> None:
    shown = visit("chapters/01-talk.html")
    shown.page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    shown.page.get_by_role("button", name="Copy talker.py").click()
    expect(shown.page.locator("#said")).to_have_text("Copied", timeout=DEADLINE_MS)
    copied = shown.page.evaluate("navigator.clipboard.readText()")
    assert copied.strip() == (built.site / "downloads" / "talker.py").read_text().strip()


def test_the_keyboard_reaches_the_text_first(visit: Visit) -> None:
    shown = visit("chapters/01-talk.html")
    shown.page.keyboard.press("Tab")
    shown.page.keyboard.press("Enter")
    expect(shown.page.locator("#content")).to_be_focused()


def test_the_menu_of_a_phone_opens_and_closes_by_keyboard(visit: Visit) -> None:
    shown = visit("chapters/01-talk.html", width=390)
    link = shown.page.get_by_role("navigation", name="Course").get_by_role("link", name="Glossary")
    expect(link).to_be_hidden()
    shown.page.get_by_role("button", name="Contents").press("Enter")
    expect(link).to_be_visible(timeout=DEADLINE_MS)
    shown.page.keyboard.press("Escape")
    expect(link).to_be_hidden(timeout=DEADLINE_MS)


def edges(place: Locator) -> list[float]:
    """The brightness of the left and right edge: the median over the height, so that letters do not count."""
    picture = np.asarray(Image.open(io.BytesIO(place.screenshot())).convert("L"))
    return [float(np.median(picture[:, x])) for x in (1, -2)]


def test_on_a_phone_a_wide_table_stacks_its_cells_below_their_columns_names(visit: Visit) -> None:
    shown = visit("chapters/02-more.html", width=390)
    cells = shown.page.get_by_role("table").filter(has_text="colcon does").get_by_role("cell")
    lefts = cells.evaluate_all("cells => cells.map((cell) => cell.getBoundingClientRect().left)")
    assert len(lefts) == 4
    assert len(set(lefts)) == 1
    assert cells.last.evaluate("cell => getComputedStyle(cell, '::before').content") == '"Since"'


def test_a_chapter_is_read_part_by_part_and_stays_one_document(visit: Visit, address: str) -> None:
    shown = visit("chapters/02-more.html")
    page = shown.page
    options = page.get_by_role("heading", name="Options")
    last = page.get_by_role("heading", name="Last words")
    expect(options).to_be_visible()
    expect(last).to_be_hidden()
    page.get_by_role("link", name="Page 2 · 15 minutes Last words").press("Enter")
    expect(last).to_be_visible()
    expect(options).to_be_hidden()
    expect(page.locator("#said")).to_have_text("Page 2 of 2")
    assert shown.violations() == []
    page.go_back()
    expect(options).to_be_visible()
    page.goto(f"{address}/chapters/01-talk.html")
    page.goto(f"{address}/chapters/02-more.html#last-words")
    expect(last).to_be_in_viewport()
    expect(options).to_be_hidden()
    page.emulate_media(media="print")
    expect(options).to_be_visible()
    page.emulate_media(media="screen")
    page.get_by_role("button", name="Whole chapter").click()
    expect(options).to_be_visible()
    expect(last).to_be_visible()
    page.goto(f"{address}/index.html")
    expect(page.locator(".chapter-list .facts").last).to_have_text(re.compile(r"Week 2.*2 pages read"))
    assert shown.faults == []


def test_an_answer_is_folded_until_a_guess_is_made_and_the_guess_is_kept(visit: Visit) -> None:
    shown = visit("chapters/02-more.html#guess-1")
    page = shown.page
    answer = page.get_by_text("It is “word”.")
    expect(page.get_by_role("radiogroup", name="Guess before you look.")).to_be_visible()
    expect(answer).to_be_hidden()
    expect(page.get_by_text("or run the code")).to_be_visible()
    assert shown.violations() == []
    page.get_by_role("radio", name="None", exact=True).check()
    expect(answer).to_be_visible()
    expect(page.locator(".guess-told")).to_have_text("You guessed: None. See the answer.")
    assert shown.violations() == []
    page.reload()
    expect(page.get_by_role("radio", name="None", exact=True)).to_be_checked()
    page.get_by_role("radio", name="One", exact=True).check()
    expect(page.locator(".guess-told")).to_have_text("You guessed: One. That is right.")
    assert shown.faults == []


def test_without_scripts_a_chapter_is_whole(browser: Browser, address: str) -> None:
    context = browser.new_context(java_script_enabled=False)
    page = context.new_page()
    page.goto(f"{address}/chapters/02-more.html")
    expect(page.get_by_role("heading", name="Options")).to_be_visible()
    expect(page.get_by_role("heading", name="Last words")).to_be_visible()
    assert "Running and checking programs in the page needs JavaScript." in page.inner_text("main")
    context.close()


def test_on_a_phone_code_in_a_sentence_does_not_break_at_its_hyphens(visit: Visit) -> None:
    shown = visit("chapters/02-more.html", width=390)
    lines = shown.page.locator("main p:not(td p) code").evaluate_all(
        """codes => codes.map(code => {
            const text = document.createRange();
            text.selectNodeContents(code);
            return [code.innerText, new Set([...text.getClientRects()].map(box => box.top)).size];
        })"""
    )
    paragraph = shown.page.locator("main p", has_text="colcon links")
    height = paragraph.evaluate("words => words.getClientRects()[0].height")
    assert height > 100, "lines end next to some of them"
    assert len(lines) >= 6
    assert [text for text, count in lines if count != 1] == []


def test_a_chapter_is_below_a_megabyte_over_the_wire(browser: Browser, built: SmallCourse, address: str) -> None:
    asked: list[str] = []
    with opened(browser, "about:blank") as shown:
        shown.page.on("request", lambda request: asked.append(request.url))
        shown.page.goto(f"{address}/chapters/01-talk.html", wait_until="networkidle")
    files = [built.site / url.removeprefix(f"{address}/").partition("?")[0] for url in asked]
    assert len(files) > 4
    assert sum(len(gzip.compress(file.read_bytes())) for file in files) < 1_000_000


@pytest.fixture(scope="module")
def longer(browser: Browser, programs: str) -> Iterator[Opened]:
    """A chapter with nodes, a command and housekeeping, which were not run."""
    with opened(browser, f"{programs}/chapters/longer.html") as shown:
        yield shown


@pytest.mark.parametrize("width", [390, 1280])
def test_a_head_is_one_row_and_housekeeping_one_line(longer: Opened, width: int) -> None:
    longer.page.set_viewport_size({"width": width, "height": 900})
    longer.page.reload()
    height = "all => all.map(one => one.getBoundingClientRect().height)"
    expect(longer.page.get_by_role("button", name=re.compile("^Run "))).to_have_count(4)
    heads = longer.page.locator(".cell-head").evaluate_all(height)
    assert len(heads) == 4
    assert max(heads) <= 46
    assert longer.page.locator(".cell-strip").evaluate_all(height) == [pytest.approx(43, abs=4)]
    expect(longer.page.get_by_text("Run starts a program here, in your browser.")).to_have_count(1)
    choose(longer.page.locator(".cell-node").first, "Download speaker.py")
    expect(longer.page.locator(".more[open]")).to_have_count(0)


def test_a_command_wraps_and_code_shows_that_it_scrolls(longer: Opened) -> None:
    cut = "pre => pre.scrollWidth > pre.clientWidth"
    assert not longer.page.locator(".cell-shell pre").evaluate(cut)
    code = longer.page.get_by_role("group", name="Code, scrolls sideways").last
    assert code.evaluate(cut)
    left, right = edges(code)
    assert right < left - 20


def test_a_main_as_before_opens_and_is_whole_in_print_and_without_scripts(longer: Opened) -> None:
    main = longer.page.locator(".as-before")
    button = longer.page.get_by_role("button", name="main() as before")
    expect(main).to_be_hidden()
    expect(longer.page.locator(".cell-node .cell_input").nth(1)).to_contain_text("rclpy.spin(node)")
    button.press("Enter")
    expect(main).to_be_visible()
    button.click()
    expect(main).to_be_hidden()
    longer.page.emulate_media(media="print")
    expect(main).to_be_visible()
    expect(button).to_be_hidden()
    longer.page.emulate_media(media="screen")
    longer.page.evaluate("document.documentElement.classList.remove('js')")
    expect(main).to_be_visible()
    expect(button).to_be_hidden()


def test_what_moves_stands_still_on_paper_and_for_those_who_prefer_no_motion(visit: Visit) -> None:
    shown = visit("chapters/01-talk.html")
    opening = shown.page.locator(".opening img.moving")
    expect(opening).to_be_visible()
    assert opening.evaluate("image => image.clientWidth") >= 380, "the letters of what is wide can be read"
    output = shown.page.locator(".cell_output")
    moving, still = output.locator("img.moving"), output.locator("img.still")
    expect(moving).to_be_visible()
    expect(still).to_be_hidden()
    output.get_by_role("button", name="Pause this picture").click()
    expect(moving).to_be_hidden()
    expect(still).to_be_visible()
    output.get_by_role("button", name="Play this picture").click()
    expect(moving).to_be_visible()
    shown.page.emulate_media(reduced_motion="reduce")
    expect(moving).to_be_hidden()
    expect(still).to_be_visible()
    shown.page.emulate_media(media="print", reduced_motion="no-preference")
    expect(moving).to_be_hidden()
    expect(still).to_be_visible()
    expect(still).to_have_js_property("naturalWidth", 300)
    expect(still).to_have_js_property("loading", "lazy")
    address = still.evaluate("image => image.src")
    assert "animation" not in shown.page.request.get(address).text()
    assert shown.faults == []


@pytest.mark.soak
def test_while_an_author_writes_the_open_page_follows(browser: Browser, course: SmallCourse) -> None:
    with course.serving() as address, opened(browser, f"{address}/chapters/02-more.html") as shown:
        with shown.page.expect_websocket(timeout=DEADLINE_MS):
            shown.page.reload()
        course.change("chapters/02-more.md", "Words only.", "Words that were saved just now.")
        expect(shown.page.get_by_text("saved just now")).to_be_visible(timeout=2 * DEADLINE_MS)
        assert shown.faults == []


def test_a_chapter_prints(visit: Visit) -> None:
    shown = visit("chapters/01-talk.html", scheme="dark")
    assert shown.page.pdf(format="A4").startswith(b"%PDF")
    shown.page.emulate_media(media="print")
    assert shown.page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
    expect(shown.page.get_by_role("navigation", name="Course")).to_be_hidden()
