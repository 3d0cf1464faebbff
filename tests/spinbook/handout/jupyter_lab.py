"""A real JupyterLab, and its page in a real browser."""

from __future__ import annotations

import json
import os
import re
import secrets
import subprocess
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from playwright.sync_api import Browser, Locator, Page, expect

#: How long anything on the page may take, on a busy machine (ms).
DEADLINE_MS = 90_000

#: JupyterLab of the environment that runs the tests.
HERE = (sys.executable, "-m", "jupyterlab")


@contextmanager
def jupyter_lab(folder: Path, state: Path, command: Sequence[str] = HERE) -> Iterator[str]:
    """Run JupyterLab in `folder`, with its own files in `state`. Yields a notebook's URL, with {} for its name."""
    token = secrets.token_hex(8)
    settings = state / "settings" / "@jupyterlab" / "apputils-extension" / "notification.jupyterlab-settings"
    settings.parent.mkdir(parents=True)
    settings.write_text(json.dumps({"fetchNews": "false", "checkForUpdates": False}))
    names = ("CONFIG", "DATA", "RUNTIME")
    places = {f"JUPYTER_{name}_DIR": str(state / name.lower()) for name in names}
    places |= {"JUPYTERLAB_SETTINGS_DIR": str(state / "settings"), "JUPYTERLAB_WORKSPACES_DIR": str(state / "spaces")}
    words = [*command, "--no-browser", "--ServerApp.ip=127.0.0.1", "--allow-root"]
    words += [f"--IdentityProvider.token={token}", "--ServerApp.port=0"]
    environment = {**(os.environ if command is HERE else a_new_terminal()), **places}
    with (state / "log").open("w") as log:
        server = subprocess.Popen(words, cwd=folder, env=environment, stdout=log, stderr=subprocess.STDOUT)
        try:
            yield f"{_address(server, state / 'log')}lab/tree/{{}}?token={token}"
        finally:
            server.terminate()
            server.wait(60)


def a_new_terminal() -> dict[str, str]:
    """Return the environment, without what this Python's own has set in it."""
    ours = ("_ROS_WHEELS_BOOTSTRAP_COMPLETE", "LD_LIBRARY_PATH", "VIRTUAL_ENV", "PYTHONPATH")
    return {name: value for name, value in os.environ.items() if name not in ours}


def _address(server: subprocess.Popen[bytes], log: Path) -> str:
    deadline = time.monotonic() + DEADLINE_MS / 1000
    while time.monotonic() < deadline and server.poll() is None:
        if found := re.search(r"http://127\.0\.0\.1:(\d+)/", log.read_text(errors="replace")):
            return found[0]
        time.sleep(0.1)
    raise AssertionError(f"JupyterLab did not start:\n{log.read_text(errors='replace')}")


@dataclass
class Notebook:
    """An open notebook, used as a student would."""

    page: Page

    def run_all(self) -> None:
        """Run > Run All Cells."""
        self.page.get_by_role("menuitem", name="Run", exact=True).click()
        self.page.get_by_role("menuitem", name="Run All Cells", exact=True).click()

    def cell(self, text: str) -> Locator:
        """Return the code cell with this text."""
        return self.page.locator(".jp-CodeCell").filter(has_text=text).first

    def type_into(self, text: str, code: str) -> None:
        """Replace the text of the cell with this text by `code`."""
        self.cell(text).locator(".cm-content").click()
        self.page.keyboard.press("Control+A")
        self.page.keyboard.insert_text(code)

    def run(self, text: str) -> None:
        """Click into the cell and press Ctrl+Enter."""
        self.cell(text).locator(".cm-content").click()
        self.page.keyboard.press("Control+Enter")

    def add_below(self, text: str, code: str) -> None:
        """Add a cell with `code` below the one with this text, and run it with Ctrl+Enter."""
        self.cell(text).locator(".cm-content").click()
        self.page.keyboard.press("Escape")
        self.page.keyboard.press("b")
        self.page.keyboard.press("Enter")
        self.page.keyboard.insert_text(code)
        self.page.keyboard.press("Control+Enter")

    def save(self) -> None:
        """Ctrl+S."""
        self.page.keyboard.press("Control+S")
        expect(self.page.locator(".jp-mod-current .jp-DirtyIndicator, .jp-mod-current.jp-mod-dirty")).to_have_count(0)


@contextmanager
def opened_notebook(browser: Browser, url: str, name: str) -> Iterator[Notebook]:
    """Open the notebook `name` in JupyterLab, its kernel idle. The window is high: cells out of sight are not drawn."""
    context = browser.new_context(viewport={"width": 1280, "height": 2600})
    try:
        page = context.new_page()
        page.set_default_timeout(DEADLINE_MS)
        page.goto(url.format(name))
        page.locator(".jp-Notebook .jp-CodeCell").first.wait_for()
        # The notebook's own status is green before there is a kernel; a cell run then would be lost.
        page.locator(".jp-StatusBar-TextItem, .jp-StatusBar-GroupItem").get_by_text("| Idle").first.wait_for()
        yield Notebook(page)
    finally:
        context.close()
