"""What a page can't do it says in one sentence, and the rest still works: in a real Chromium."""

from __future__ import annotations

import re
from collections.abc import Iterator

import pytest
from browser import Opened, opened, write_code
from playwright.sync_api import Browser, BrowserContext, Locator, Route, expect

from spinbook.browser.files import can_run

pytestmark = pytest.mark.skipif(not can_run(), reason="set-up could not fetch Pyodide from npm")

#: Pyodide starts in a few seconds; on a busy machine, in many.
DEADLINE_MS = 120_000
WITHOUT_JSPI = "delete WebAssembly.Suspending; delete WebAssembly.promising;"
#: What a browser does that has no memory left for another program.
WITHOUT_MEMORY = """
WebAssembly.instantiateStreaming = WebAssembly.instantiate = async () => {
  throw new RangeError("WebAssembly.instantiate(): Out of memory: Cannot allocate Wasm memory for new instance");
};
"""
#: Two threads wait deep in calls from C, while the main thread calls deeper than one of them and makes much garbage.
GARBAGE = """
import threading

class Nested:
    def __init__(self, depth, then):
        self.depth, self.then = depth, then

    def __getattr__(self, name):  # called from C: each level lies on the argument stack
        return getattr(Nested(self.depth - 1, self.then), name) if self.depth else self.then()

def make_garbage():
    for _ in range(100_000):
        ring = []
        ring.append(ring)
    return 'made'

go_on = threading.Event()
waiting = [threading.Thread(target=lambda depth=depth: Nested(depth, go_on.wait).value) for depth in (30, 5)]
for thread in waiting:
    thread.start()
threading.Event().wait(0.1)
print(Nested(40, make_garbage).value)
go_on.set()
for thread in waiting:
    thread.join()
print('all threads went on')
"""

#: The lines on which the program is to blame, and no others.
FORGOT = re.compile(
    r"Traceback \(most recent call last\):\s*"
    r'File "talker\.py", line 3, in <module>\s*rclpy\.node\.Node\(\'talker\'\)[\s^]*'
    r"AttributeError: module 'rclpy' has no attribute 'node'\s*"
)


@pytest.fixture(scope="module")
def shown(reader: BrowserContext, address: str) -> Iterator[Opened]:
    """One page for all tests: its plain cells share one process."""
    with opened(reader, f"{address}/chapters/01-talk.html") as page:
        yield page


def run(cell: Locator, code: str) -> Locator:
    """Put the code into the cell and run it; return its output."""
    write_code(cell, code)
    cell.get_by_role("button", name="Run").first.click()
    return cell.get_by_role("log")


SENTENCES = {
    # It does have threads: they take turns.
    "import threading\nthreading.Thread(target=print, args=('from a thread',)).start()": "from a thread",
    "from concurrent.futures import ThreadPoolExecutor\nThreadPoolExecutor().submit(lambda: 6 * 7).result()": "42",
    "import numpy as np\nnp.linspace(0, 1)": "a web page does not have numpy",
    "import matplotlib.pyplot": "This program imports matplotlib, which a web page does not have.",
    "from cv_bridge import CvBridge": "This program imports cv_bridge, which a web page does not have.",
    "import subprocess\nsubprocess.run(['ls'])": "This program starts another one, which a web page can't.",
    "input('How far? ')": "a web page has no terminal to type in",
    "raise MemoryError": "This program needs more memory than a web page has.",
    "from time import sleep\nsleep(0.01)\nprint('slept')": "slept",
    "import threading\nprint(threading.Event().wait(0.01))": "False",
    "import rclpy\nrclpy.node": "AttributeError: module 'rclpy' has no attribute 'node'",
}


def test_a_program_that_needs_more_than_a_page_has_is_reported(shown: Opened) -> None:
    cell = shown.page.locator(".cell-snippet").first
    for code, sentence in SENTENCES.items():
        expect(run(cell, code)).to_contain_text(sentence, timeout=DEADLINE_MS)
    assert shown.faults == []


def test_a_node_that_forgets_an_import_fails_as_in_a_new_python(shown: Opened) -> None:
    output = run(shown.page.locator(".cell-node").first, "import rclpy\nrclpy.init()\nrclpy.node.Node('talker')")
    expect(output).to_have_text(FORGOT, timeout=DEADLINE_MS)
    assert shown.faults == []


def test_garbage_is_collected_while_threads_wait(shown: Opened) -> None:
    output = run(shown.page.locator(".cell-snippet").first, GARBAGE)
    expect(output).to_contain_text("all threads went on", timeout=DEADLINE_MS)
    assert shown.faults == []


def test_a_cell_that_computes_for_ever_can_be_stopped(shown: Opened) -> None:
    cell = shown.page.locator(".cell-snippet").first
    expect(run(cell, "print('begins')\nwhile True: pass")).to_contain_text("begins", timeout=DEADLINE_MS)
    bar = shown.page.get_by_role("region", name="Running nodes")
    bar.get_by_role("button", name="Stop all nodes").click()
    expect(cell.get_by_role("status")).to_contain_text("It was ended, so the variables", timeout=DEADLINE_MS)
    expect(bar).to_be_hidden(timeout=DEADLINE_MS)


@pytest.mark.soak
def test_a_node_that_computes_for_ever_is_reported_and_can_be_stopped(shown: Opened) -> None:
    node = shown.page.locator(".cell-node").first
    expect(run(node, "print('begins')\nwhile True: pass")).to_contain_text("begins", timeout=DEADLINE_MS)
    state = node.get_by_role("status")
    expect(state).to_contain_text("talker computes without a pause", timeout=DEADLINE_MS)
    shown.page.get_by_role("button", name="Stop talker").click()
    expect(state).to_contain_text("talker did not react to Ctrl-C, so it was ended after 2 s.", timeout=DEADLINE_MS)


def test_a_browser_without_promise_integration_is_reported(browser: Browser, address: str) -> None:
    with opened(browser, f"{address}/chapters/01-talk.html") as page:
        page.page.add_init_script(WITHOUT_JSPI)
        page.page.reload()
        page.page.get_by_role("button", name="Run talker.py", exact=True).click()
        state = page.page.locator(".cell-node").get_by_role("status")
        expect(state).to_contain_text("This browser can't run nodes", timeout=DEADLINE_MS)
        assert "A publisher sends messages." in page.page.inner_text("main")
        assert page.violations() == []
        assert page.faults == []


def test_a_browser_without_memory_for_another_node_is_reported(browser: Browser, address: str) -> None:
    def exhausted(route: Route) -> None:
        response = route.fetch()
        route.fulfill(response=response, body=WITHOUT_MEMORY + response.text())

    with opened(browser, f"{address}/chapters/01-talk.html") as page:
        page.page.context.route("**/run/pyodide.mjs", exhausted)
        page.page.get_by_role("button", name="Run talker.py", exact=True).click()
        state = page.page.locator(".cell-node").get_by_role("status")
        expect(state).to_contain_text("There is not enough memory for this. Stop a node", timeout=DEADLINE_MS)
