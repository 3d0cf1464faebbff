"""Pages run their own nodes in a real Firefox, from a plain server with a strict content security policy."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from firefox import PROGRAM, Firefox, firefox

from spinbook.browser.files import can_run

pytestmark = [
    pytest.mark.soak,
    pytest.mark.timeout(900),
    pytest.mark.skipif(not can_run(), reason="set-up could not fetch Pyodide from npm"),
    pytest.mark.skipif(
        PROGRAM is None, reason="not tried: Firefox is not installed (sudo apt-get install firefox-esr)"
    ),
]

WITHOUT_JSPI = 'user_pref("javascript.options.wasm_js_promise_integration", false);'
LOG = ".cell-node .ran [role=log]"


@pytest.fixture(scope="module")
def page(address: str, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Firefox]:
    """A chapter's page in a Firefox with a fresh profile."""
    with firefox(tmp_path_factory.mktemp("firefox")) as running:
        running.open(f"{address}/chapters/01-talk.html")
        if not running.evaluate("return 'Suspending' in WebAssembly"):
            pytest.skip("this Firefox is older than 153 and has no JavaScript Promise Integration")
        yield running


def test_a_page_runs_edits_and_stops_a_node(page: Firefox) -> None:
    page.click("Run talker.py")
    page.wait_for(LOG, "[INFO] [talker]: number 3")
    page.wait_for(".running", "talker")
    page.click("Node graph")
    page.wait_for(".graph-panel svg", "talker")

    page.evaluate("document.querySelector('.cell-node pre').click()")
    page.wait_for(".cell-node .cm-content", "class Talker")
    page.type(".cell-node .cm-content", "# one\n\n# two\n")
    page.wait_for(".cell-node .cm-content", "# one# two")
    page.wait_for(".cell-node .edited", "edited")

    page.click("Reset talker")
    page.click("Run talker.py")
    page.wait_for(LOG, "[talker]: number 3")
    page.click("Stop talker")
    page.wait_for(".cell-node .run-state", "talker ended with 0.")


def test_clocks_stay_right_in_a_hidden_tab(page: Firefox) -> None:
    page.click("Run talker.py")
    page.wait_for(LOG, "[talker]: number 3")
    with page.in_another_tab():
        assert page.evaluate("return document.visibilityState") == "hidden"
        calls = page.evaluate(
            "const log = document.querySelector(arguments[0]); const before = log.childElementCount;"
            "for (let i = 0; i < 4; i++) await new Promise((done) => setTimeout(done, 100));"
            "return log.childElementCount - before",
            LOG,
        )
    page.click("Stop talker")
    assert calls > 20, "the browser slows the page's own timer of 0.1 s down to 1 s, and the node's stays what it is"


def test_an_error_in_a_worker_arrives_with_its_message(page: Firefox) -> None:
    said = page.evaluate(
        "const { take } = await import(new URL('../run/processes.js', location.href));"
        "const worker = take('broken', {}); await worker.ready;"
        "const said = await worker.call('timeline.drawn', { names: [], lines: null, title: '' }).catch(String);"
        "worker.end(); return said"
    )
    assert "object is not iterable" in said


def test_an_exercise_is_checked(page: Firefox, address: str) -> None:
    solution = Path(__file__).parents[3] / "solutions" / "joint_velocity" / "solution.py"
    page.open(f"{address}/exercises/joint_velocity.html")
    page.click("Edit and check the starter here")
    page.wait_for(".check-tools", "Check")
    page.evaluate(
        "const chosen = new DataTransfer(); chosen.items.add(new File([arguments[0]], 'mine.py'));"
        "const field = document.querySelector('input[type=file]');"
        "field.files = chosen.files; field.dispatchEvent(new Event('change'));",
        solution.read_text(),
    )
    page.wait_for(".edit-notes", "Your program is from mine.py.")
    page.click("Check joint_velocity.py")
    page.wait_for(".check-total", "9 of 9 public checks, 37 of 37 points")


def test_a_firefox_without_promise_integration_reads_and_says_why_it_can_not_run(address: str, tmp_path: Path) -> None:
    with firefox(tmp_path, WITHOUT_JSPI) as running:
        running.open(f"{address}/chapters/01-talk.html")
        assert running.evaluate("return 'Suspending' in WebAssembly") is False
        running.click("Run talker.py")
        running.wait_for(".cell-node .run-state", "Chrome and Edge 137 or newer and Firefox 153 or newer have it.")
        running.wait_for("main", "A publisher sends messages.")
