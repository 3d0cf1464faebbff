"""The site in a real Chromium: on a phone and a desk, light and dark, served and from a folder."""

from __future__ import annotations

import gzip
import io
import json
import re
import shutil
import statistics
from collections.abc import Iterator
from pathlib import Path

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


@pytest.mark.parametrize("from_folder", [True, False])
def test_the_search_finds_publisher(browser: Browser, built: SmallCourse, address: str, from_folder: bool) -> None:
    start: str | Path = built.site / "chapters" / "01-talk.html" if from_folder else f"{address}/chapters/01-talk.html"
    with opened(browser, start) as shown:
        shown.page.get_by_role("searchbox").fill("publisher")
        shown.page.get_by_role("searchbox").press("Enter")
        results = shown.page.locator("#search-results li")
        expect(results.first).to_be_visible(timeout=DEADLINE_MS)
        assert "Publisher" in results.first.inner_text()
        results.get_by_role("link", name="Talk", exact=True).click()
        expect(shown.page.get_by_role("heading", level=1)).to_contain_text("Talk", timeout=DEADLINE_MS)
        assert shown.faults == []


@pytest.mark.parametrize("from_folder", [True, False])
def test_the_search_answers_while_one_types_and_forgives(
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
        assert shown.faults == []


def test_a_chapter_tells_how_far_one_has_read_and_its_end_leads_back(browser: Browser, address: str) -> None:
    with opened(browser, f"{address}/chapters/01-talk.html", height=300) as shown:
        bar, back = shown.page.locator("progress.reading"), shown.page.get_by_role("link", name="Back to top")
        assert bar.evaluate("bar => bar.value") == 0
        expect(back).not_to_be_in_viewport()
        shown.page.evaluate("scrollTo(0, document.documentElement.scrollHeight)")
        shown.page.wait_for_function("document.querySelector('progress.reading').value > 990")
        back.click()
        expect(back).not_to_be_in_viewport()


def test_the_switch_changes_colours_and_they_stay(browser: Browser, address: str) -> None:
    with opened(browser, f"{address}/index.html") as shown:
        light = shown.page.evaluate("getComputedStyle(document.body).backgroundColor")
        shown.page.get_by_role("button", name="Dark colours").click()
        dark = shown.page.evaluate("getComputedStyle(document.body).backgroundColor")
        assert dark != light
        shown.page.goto(f"{address}/glossary.html")
        assert shown.page.evaluate("getComputedStyle(document.body).backgroundColor") == dark


def test_copying_gives_the_node_s_code(browser: Browser, built: SmallCourse, address: str) -> None:
    with opened(browser, f"{address}/chapters/01-talk.html") as shown:
        shown.page.context.grant_permissions(["clipboard-read", "clipboard-write"])
        shown.page.get_by_role("button", name="Copy talker.py").click()
        expect(shown.page.locator("#said")).to_have_text("Copied", timeout=DEADLINE_MS)
        copied = shown.page.evaluate("navigator.clipboard.readText()")
    assert copied.strip() == (built.site / "downloads" / "talker.py").read_text().strip()


def test_the_keyboard_reaches_the_text_first(browser: Browser, address: str) -> None:
    with opened(browser, f"{address}/chapters/01-talk.html") as shown:
        shown.page.keyboard.press("Tab")
        shown.page.keyboard.press("Enter")
        assert shown.page.evaluate("document.activeElement.id") == "content"


def test_the_menu_of_a_phone_opens_and_closes_by_keyboard(browser: Browser, address: str) -> None:
    with opened(browser, f"{address}/chapters/01-talk.html", width=390) as shown:
        link = shown.page.get_by_role("navigation", name="Course").get_by_role("link", name="Glossary")
        expect(link).to_be_hidden()
        shown.page.get_by_role("button", name="Contents").press("Enter")
        expect(link).to_be_visible(timeout=DEADLINE_MS)
        shown.page.keyboard.press("Escape")
        expect(link).to_be_hidden(timeout=DEADLINE_MS)


def edges(place: Locator) -> list[float]:
    """The brightness of the left and right edge: the median over the height, so that letters do not count."""
    picture = Image.open(io.BytesIO(place.screenshot())).convert("L")
    return [statistics.median(picture.getpixel((x, y)) for y in range(picture.height)) for x in (1, picture.width - 2)]


def test_on_a_phone_a_wide_table_stacks_its_cells_below_their_columns_names(browser: Browser, address: str) -> None:
    with opened(browser, f"{address}/chapters/02-more.html", width=390) as shown:
        cells = shown.page.get_by_role("table").filter(has_text="colcon does").get_by_role("cell")
        lefts = cells.evaluate_all("cells => cells.map((cell) => cell.getBoundingClientRect().left)")
        assert len(lefts) == 4
        assert len(set(lefts)) == 1
        assert cells.last.evaluate("cell => getComputedStyle(cell, '::before').content") == '"Since"'


def test_a_chapter_is_read_part_by_part_and_stays_one_document(browser: Browser, address: str) -> None:
    with opened(browser, f"{address}/chapters/02-more.html") as shown:
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


def test_an_answer_is_folded_until_a_guess_is_made_and_the_guess_is_kept(browser: Browser, address: str) -> None:
    with opened(browser, f"{address}/chapters/02-more.html#guess-1") as shown:
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
    context.close()


def test_on_a_phone_code_in_a_sentence_does_not_break_at_its_hyphens(browser: Browser, address: str) -> None:
    with opened(browser, f"{address}/chapters/02-more.html", width=390) as shown:
        lines = shown.page.locator("main p:not(td p) code").evaluate_all(
            """codes => codes.map(code => {
                const text = document.createRange();
                text.selectNodeContents(code);
                return [code.innerText, new Set([...text.getClientRects()].map(box => box.top)).size];
            })"""
        )
        paragraph = shown.page.locator("main p", has_text="colcon links")
        assert (
            paragraph.evaluate("words => words.getClientRects()[0].height") > 100
        )  # so lines end next to some of them
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


#: A node with the talker's main(), a command and a line of code that are longer than a window, and housekeeping.
LONGER = f"""
```python title="listener.py"
class Listener(Node):
    TOPICS = [{", ".join(f"'/topic_{number}'" for number in range(20))}]
MAIN```

```bash
ros2 topic pub --rate 2 /joint_commands sensor_msgs/msg/JointState "{{name: [left_elbow], position: [{"0.5, " * 30}]}}"
```

```python
%stop --all
```
"""


@pytest.fixture(scope="module")
def changed(built: SmallCourse, tmp_path_factory: pytest.TempPathFactory) -> SmallCourse:
    """A course with more blocks, which were not run, and a picture that moves."""
    root = tmp_path_factory.mktemp("changed") / "course"
    shutil.copytree(built.root, root)
    course = SmallCourse(root)
    chapter = root / "chapters" / "01-talk.md"
    main = re.search(r"\n\ndef main.*?(?=```)", chapter.read_text(), re.DOTALL)
    assert main
    chapter.write_text(chapter.read_text() + LONGER.replace("MAIN", main.group().replace("Talker", "Listener")))
    executed = course.root / "build" / "executed" / "01-talk.ipynb"
    notebook = json.loads(executed.read_text())
    (picture,) = (o for c in notebook["cells"] for o in c.get("outputs", []) if "image/png" in o.get("data", {}))
    picture["data"]["image/svg+xml"] = '<svg xmlns="http://www.w3.org/2000/svg" width="42" height="24"></svg>'
    executed.write_text(json.dumps(notebook))
    assert course.spinbook_site("--no-run").returncode == 0
    return course


@pytest.mark.parametrize("width", [1280, 390])
def test_a_head_is_one_row_and_housekeeping_one_line(browser: Browser, changed: SmallCourse, width: int) -> None:
    with opened(browser, changed.site / "chapters" / "01-talk.html", width=width) as shown:
        height = "all => all.map(one => one.getBoundingClientRect().height)"
        heads = shown.page.locator(".cell-head").evaluate_all(height)
        assert len(heads) == 6
        assert max(heads) <= 46
        assert shown.page.locator(".cell-strip").evaluate_all(height) == [pytest.approx(43, abs=4)]
        assert shown.page.get_by_role("button", name=re.compile("^Run ")).count() == 6
        expect(shown.page.get_by_text("Run starts a program here, in your browser.")).to_have_count(1)
        choose(shown.page.locator(".cell-node").first, "Download talker.py")
        expect(shown.page.locator(".more[open]")).to_have_count(0)


def test_a_main_as_before_opens_and_is_whole_in_print_and_without_scripts(
    browser: Browser, changed: SmallCourse
) -> None:
    with opened(browser, changed.site / "chapters" / "01-talk.html") as shown:
        main = shown.page.locator(".as-before")
        button = shown.page.get_by_role("button", name="main() as before")
        expect(main).to_be_hidden()
        expect(shown.page.locator(".cell-node .cell_input").nth(1)).to_contain_text("rclpy.spin(node)")
        button.press("Enter")
        expect(main).to_be_visible()
        button.click()
        expect(main).to_be_hidden()
        shown.page.emulate_media(media="print")
        expect(main).to_be_visible()
        expect(button).to_be_hidden()
        shown.page.emulate_media(media="screen")
        shown.page.evaluate("document.documentElement.classList.remove('js')")
        expect(main).to_be_visible()
        expect(button).to_be_hidden()


def test_a_command_wraps_and_code_shows_that_it_scrolls(browser: Browser, changed: SmallCourse) -> None:
    with opened(browser, changed.site / "chapters" / "01-talk.html") as shown:
        cut = "pre => pre.scrollWidth > pre.clientWidth"
        assert not shown.page.locator(".cell-shell pre").evaluate(cut)
        code = shown.page.get_by_role("group", name="Code, scrolls sideways").last
        assert code.evaluate(cut)
        left, right = edges(code)
        assert right < left - 20


def test_what_moves_stands_still_on_paper_and_for_those_who_prefer_no_motion(
    browser: Browser, changed: SmallCourse
) -> None:
    with opened(browser, changed.site / "chapters" / "01-talk.html") as shown:
        expect(shown.page.locator(".opening img.moving")).to_be_visible()
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
        assert still.evaluate("image => image.complete && image.naturalWidth > 42 && image.loading") == "lazy"
        assert shown.faults == []


@pytest.mark.soak
def test_while_an_author_writes_the_open_page_follows(browser: Browser, course: SmallCourse) -> None:
    with course.serving() as address, opened(browser, f"{address}/chapters/02-more.html") as shown:
        with shown.page.expect_websocket(timeout=DEADLINE_MS):
            shown.page.reload()
        course.change("chapters/02-more.md", "Words only.", "Words that were saved just now.")
        expect(shown.page.get_by_text("saved just now")).to_be_visible(timeout=2 * DEADLINE_MS)
        assert shown.faults == []


def test_a_chapter_prints(browser: Browser, address: str) -> None:
    with opened(browser, f"{address}/chapters/01-talk.html", dark=True) as shown:
        assert shown.page.pdf(format="A4").startswith(b"%PDF")
        shown.page.emulate_media(media="print")
        assert shown.page.evaluate("getComputedStyle(document.body).backgroundColor") == "rgb(255, 255, 255)"
        expect(shown.page.get_by_role("navigation", name="Course")).to_be_hidden()
