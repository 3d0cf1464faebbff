"""Pages run their own nodes: in a real Chromium, from a plain server with a strict content security policy."""

from __future__ import annotations

import re
import shutil
import zipfile
from pathlib import Path

import pytest
from browser import Opened, choose, code_in, opened, write_code
from playwright.sync_api import Browser, BrowserContext, expect
from small_course import SmallCourse

from grader.exercise import load
from grader.exercise.mistakes import mistake_of
from grader.report.hint_steps import taken_in_page
from spinbook.browser.files import can_run

pytestmark = pytest.mark.skipif(not can_run(), reason="set-up could not fetch Pyodide from npm")

ROOT = Path(__file__).parents[3]
#: Pyodide starts in a few seconds; on a busy machine, in many.
DEADLINE_MS = 120_000

#: Resolves when the page has kept the whole course for reading without a network.
KEPT = """async (list) => {
  while (!(await (await caches.open('pages')).match(list))) await new Promise((resolve) => setTimeout(resolve, 50));
}"""


def requested(shown: Opened, address: str) -> list[str]:
    """Return what loading the page again requests from the server."""
    asked: list[str] = []
    shown.page.on("request", lambda request: asked.append(request.url.removeprefix(address)))
    shown.page.reload(wait_until="networkidle")
    return asked


def test_nothing_is_loaded_before_somebody_points_at_run(browser: Browser, address: str) -> None:
    with opened(browser, f"{address}/chapters/01-talk.html") as shown:
        asked = requested(shown, address)
        assert [path for path in asked if path.startswith("/_static/run.js?v=")]
        assert not [path for path in asked if path.startswith("/run/")]
        with shown.page.expect_request("**/run/files.json?*"):
            shown.page.get_by_role("button", name="Run talker.py").hover()
        assert shown.faults == []


@pytest.mark.skipif(shutil.which("node") is None, reason="Node.js compiles for pages")
def test_what_every_page_imports_at_its_start_is_compiled(built: SmallCourse) -> None:
    modules = {"ros.zip": "rclpy/node.py", "python_stdlib.zip": "asyncio/events.py"}
    for archive, module in modules.items():
        names = zipfile.ZipFile(built.site / "run" / archive).namelist()
        assert f"{module}c" in names
        assert module not in names


def test_a_page_runs_its_nodes(reader: BrowserContext, address: str) -> None:
    with opened(reader, f"{address}/chapters/01-talk.html") as shown:
        page = shown.page
        cell = page.locator(".cell-node")
        log, bar = cell.get_by_role("log"), page.get_by_role("region", name="Running nodes")

        page.get_by_role("button", name="Run talker.py").click()
        expect(log).to_contain_text("[INFO] [talker]: number 3", timeout=DEADLINE_MS)
        expect(log).to_contain_text("[WARN] [talker]: SAFETY: two")
        expect(cell.locator(".cell_output")).to_be_hidden()
        expect(bar).to_contain_text("talker")
        assert shown.violations() == []

        code = cell.get_by_role("textbox")
        before = code_in(cell)
        write_code(cell, before.replace("number", "edited"))
        code.press("Shift+Enter")
        expect(log).to_contain_text("[talker]: edited 3", timeout=DEADLINE_MS)
        expect(bar.get_by_role("listitem")).to_have_count(1)

        bar.get_by_role("button", name="Stop talker").click()
        expect(cell.get_by_role("status")).to_have_text("talker ended with 0.", timeout=DEADLINE_MS)
        expect(bar).to_be_hidden()

        choose(cell, "Reset")
        assert code_in(cell) == before
        expect(cell.locator(".cell_output")).to_be_visible()

        failing = page.locator(".cell-snippet").first
        failing.get_by_role("button", name="Run cell 2", exact=True).click()
        expect(failing.get_by_role("log")).to_contain_text("ZeroDivisionError", timeout=DEADLINE_MS)
        assert "spinbook" not in failing.get_by_role("log").inner_text()

        choose(page.locator(".cell-snippet").nth(1), "Run all above")
        expect(page.locator("#said")).to_have_text("Ran 2 cells above.", timeout=DEADLINE_MS)
        expect(log).to_contain_text("[talker]: number 3")
        page.get_by_role("button", name="Node graph").click()
        expect(page.get_by_role("region", name="Node graph")).to_contain_text("talker", timeout=DEADLINE_MS)
        assert shown.violations() == []

        write_code(cell, "from geometry_msgs.msg import Twist\n\nmsg = Twist()\nmsg.linear.w = 1.0\n")
        expect(cell.locator(".code-problem")).to_contain_text(
            "Line 4: `Vector3` has no field `w`.", timeout=DEADLINE_MS
        )
        expect(cell.locator(".cm-lintRange-error")).to_have_text("msg.linear.w = 1.0")
        code.press("Control+End")
        code.press_sequentially("msg.")
        expect(page.locator(".cm-tooltip-autocomplete")).to_contain_text("linear", timeout=DEADLINE_MS)
        assert shown.violations() == []
        for key in ("Escape", "Tab"):
            code.press(key)
        expect(code).not_to_be_focused()
        assert shown.faults == []


@pytest.mark.soak
def test_a_course_that_was_run_once_runs_without_a_network(browser: Browser, address: str) -> None:
    with opened(browser, f"{address}/chapters/01-talk.html") as shown:
        page = shown.page
        page.get_by_role("button", name="Run talker.py").click()
        log = page.locator(".cell-node").get_by_role("log")
        expect(log).to_contain_text("[talker]: number 3", timeout=DEADLINE_MS)

        assert shown.faults == []

        page.evaluate(KEPT, f"{address}/offline.json")
        page.context.set_offline(True)
        page.reload()
        assert "A publisher sends messages." in page.inner_text("main")
        page.get_by_role("button", name="Run talker.py").click()
        expect(log).to_contain_text("[talker]: number 3", timeout=DEADLINE_MS)
        expect(page.locator("main img:visible").first).to_be_attached()
        for picture in page.locator("main img:visible").all():
            expect(picture).not_to_have_js_property("naturalWidth", 0)
        page.goto(f"{address}/chapters/02-more.html")
        assert "Words only." in page.inner_text("main")
        assert page.evaluate("async () => (await fetch('../downloads/talker.py')).ok")
        page.goto(f"{address}/")
        expect(page.get_by_role("heading", level=1)).to_have_text("A small course")
        page.goto(f"{address}/search.html?q=publisher")
        expect(page.locator("#search-results li").first).to_be_visible()


def test_a_page_from_before_an_update_says_so_and_stops_what_has_not_begun(browser: Browser, address: str) -> None:
    # Requests of a page with a service worker don't reach the route.
    alone = browser.new_context(service_workers="block")
    with alone, opened(alone, f"{address}/chapters/01-talk.html") as shown:
        cell = shown.page.locator(".cell-node")
        alone.route("**/version.txt", lambda route: route.fulfill(body="newer"))
        alone.route("**/run/ros.zip*", lambda _: None)  # is never there, so Python does not start
        shown.page.get_by_role("button", name="Run talker.py").click()
        expect(shown.page.get_by_role("alert")).to_contain_text("This course was updated: reload", timeout=DEADLINE_MS)
        cell.get_by_role("button", name="Ctrl-C").click()
        expect(cell.get_by_role("status")).to_have_text("talker was ended.", timeout=DEADLINE_MS)
        expect(shown.page.get_by_role("region", name="Running nodes")).to_be_hidden()
        snippet = shown.page.locator(".cell-snippet").first
        write_code(snippet, "%nodes")
        snippet.get_by_role("button", name="Run cell 2", exact=True).click()
        expect(snippet.get_by_role("log")).to_have_text(re.compile(r"talker +ended +0 lines logged"))


def test_a_failure_of_the_network_is_called_that(browser: Browser, address: str) -> None:
    with opened(browser, f"{address}/chapters/01-talk.html") as shown:
        shown.page.context.set_offline(True)
        run = shown.page.get_by_role("button", name="Run talker.py")
        run.click()
        expect(run).to_have_text("No connection")
        expect(shown.page.locator("#said")).to_contain_text("this course's website does not answer")


def test_an_exercise_is_checked_in_its_page(reader: BrowserContext, address: str, tmp_path: Path) -> None:
    solutions = ROOT / "solutions" / "joint_velocity"
    with opened(reader, f"{address}/exercises/joint_velocity.html", width=390) as shown:
        page = shown.page
        page.get_by_role("button", name="Edit and check the starter here").click()
        total = page.locator(".check-total")

        def check(file: Path) -> None:
            page.get_by_label("A file to continue with").set_input_files(file)
            expect(page.get_by_role("textbox", name="Code of joint_velocity.py")).to_contain_text(
                file.read_text().splitlines()[0]
            )
            page.get_by_role("button", name="Check joint_velocity.py").click()

        wrong = tmp_path / "degrees.py"
        wrong.write_text(f"# Degrees.\n{mistake_of(load(ROOT / 'exercises' / 'joint_velocity'), 'degrees').source}")
        check(wrong)
        expect(total).to_have_text("7 of 9 public checks, 24 of 37 points", timeout=DEADLINE_MS)
        failed = page.locator(".check-failed")
        expect(failed).to_contain_text("Every velocity is in degrees.")
        for part in ("expected", "0.10 s after the start (message 2 of 100)", "Where to look", "What to do"):
            expect(failed).to_contain_text(part)
        expect(page.locator(".check-plot svg")).to_contain_text("first wrong")
        expect(page.locator(".check-result")).to_contain_text("Each hint that you unfold is counted.")
        failed.get_by_text("Where to look").click()
        expect(failed.get_by_text("Which line turns")).to_be_visible()
        failed.get_by_text("What to do").click()
        assert shown.violations() == []
        assert not shown.scrolls_sideways()
        check(solutions / "solution.py")
        expect(total).to_have_text("9 of 9 public checks, 37 of 37 points", timeout=DEADLINE_MS)
        expect(page.locator(".check-result")).to_contain_text("This is a preview, not your grade")
        code, older = page.get_by_role("textbox", name="Code of"), page.get_by_text("the result of the one before")
        code.press("Control+End")
        for key, shown_older in (("#", 1), ("Backspace", 0)):
            code.press(key)
            expect(older).to_have_count(shown_older)

        page.get_by_role("button", name="Try joint_velocity.py in real time").click()
        around, own = (page.get_by_role("log", name=name) for name in ("What surrounds your node", "What joint_vel"))
        expect(around).to_contain_text("from your node: /joint_velocities  header: (stamp: (sec: 100")
        expect(own).to_contain_text("6 joints arrived")
        expect(page.locator(".cm-lineNumbers")).to_be_visible()
        expect(page.get_by_text("is over. Nothing was judged")).to_be_visible()
        expect(page.locator(".check-plot svg")).to_contain_text("yours")
        expect(page.locator(".check-plot svg")).not_to_contain_text("first wrong")
        page.get_by_role("button", name="Play the scenario irregular").click()
        expect(page.get_by_text("Scenario irregular runs in real time")).to_be_visible()
        page.get_by_role("button", name="Check joint_velocity.py").click()
        expect(total).to_have_text("9 of 9 public checks, 37 of 37 points", timeout=DEADLINE_MS)
        expect(page.get_by_role("region", name="Running nodes")).to_be_hidden()
        expect(page.get_by_text("is over. Nothing was judged")).to_have_count(0)

        with page.expect_download() as download:
            page.get_by_role("button", name="Download your joint_velocity.py").click()
        assert download.value.suggested_filename == "joint_velocity.py"
        downloaded = Path(download.value.path()).read_text()
        assert downloaded.startswith((solutions / "solution.py").read_text())
        title = "Each joint's velocity is its change of position over the time between the two stamps."
        assert taken_in_page(downloaded) == {title: 2}

        page.reload()
        page.get_by_role("button", name="Edit and check the starter here").click()
        draft = page.get_by_role("textbox", name="Code of joint_velocity.py")
        expect(draft).to_contain_text((solutions / "solution.py").read_text().splitlines()[0])

        check(solutions / "right" / "numpy_arrays.py")
        expect(page.locator(".check-message")).to_contain_text("imports numpy", timeout=DEADLINE_MS)
        assert shown.faults == []


def test_the_documentation_counts_the_files_that_run_nodes(built: SmallCourse) -> None:
    in_folder = len(list((built.site / "run").iterdir()))
    assert (built.site / "offline.js").is_file()
    text = (ROOT / "docs" / "running-in-the-browser.md").read_text(encoding="utf-8")
    assert f"{in_folder + 1} files ({in_folder} in `run/`, and the service worker)" in text


def test_a_page_from_a_file_says_that_it_can_not_run(browser: Browser, built: SmallCourse) -> None:
    with opened(browser, built.site / "chapters" / "01-talk.html") as shown:
        shown.page.get_by_role("button", name="Run talker.py").click()
        expect(shown.page.locator("#said")).to_have_text("Nodes can't run in a page that is opened from a file.")
