"""A real Chromium, in which tests open the pages that Spinbook makes."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import (
    Browser,
    BrowserContext,
    ConsoleMessage,
    Locator,
    Page,
    Request,
    expect,
    sync_playwright,
)

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
LOCAL = ("file:", "data:", "blob:", "about:")

#: How long anything that has to happen in a page may take, on a busy machine (ms).
DEADLINE_MS = 90_000

#: What is off in Chromium. First what Playwright turns off, as this list replaces its own; then the pages behind the
#: address bar: without a window nobody sees them, but each window would render two, a third of the time for a page.
FEATURES_OFF = (
    *("AvoidUnnecessaryBeforeUnloadCheckSync", "DestroyProfileOnBrowserClose", "HttpsUpgrades", "LensOverlay"),
    *("HttpsFirstBalancedModeAutoEnable", "MediaRouter", "PaintHolding", "ThirdPartyStoragePartitioning"),
    *("AvoidCorsURLLoaderRestartOnRedirect", "OptimizationHints", "NetworkTimeServiceQuerying", "AimEnabled"),
    *("PreconnectToSearch", "WebUIOmniboxPopup", "WebUIOmniboxAimPopup"),
)

#: No calls home, and no GPU that a test machine would not have.
ARGUMENTS = [
    *("--disable-gpu", "--disable-background-networking", "--disable-component-update", "--disable-sync"),
    f"--disable-features={','.join(FEATURES_OFF)}",
]


@dataclass
class Opened:
    """An open page, and what it did that our pages must not do."""

    page: Page
    console: list[str] = field(default_factory=list)
    outside: list[str] = field(default_factory=list)

    def show(self, where: Path | str) -> None:
        """Load another page in the same window, which takes half as long as a window of its own; forget the faults."""
        self.console.clear()
        self.outside.clear()
        self.page.goto(_url(where), wait_until="load")

    @property
    def faults(self) -> list[str]:
        """Errors and warnings on the console, and requests to anywhere but the page's own origin."""
        return [*self.console, *(f"outside request: {url}" for url in self.outside)]

    def violations(self) -> list[str]:
        """Return what axe finds against accessibility, one line each: the rule, and the elements that break it."""
        # Some things happen a frame after the layout, such as making scrollable areas reachable by keyboard.
        self.page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
        found: list[dict[str, Any]] = Axe().run(self.page).response["violations"]
        return [f"{v['id']}: {v['help']}: {[node['html'][:200] for node in v['nodes']]}" for v in found]

    def scrolls_sideways(self) -> bool:
        """Return whether the page is wider than its window."""
        root = "document.documentElement"
        return bool(self.page.evaluate(f"{root}.scrollWidth > {root}.clientWidth"))


def code_in(place: Locator) -> str:
    """Return the code that a block or an exercise's starter shows, without line breaks at its end."""
    lines = place.locator(".cm-line")
    shown = "\n".join(lines.all_text_contents()) if lines.count() else place.locator("pre").first.text_content()
    return (shown or "").rstrip("\n")


def open_editor(place: Locator) -> Locator:
    """Click into the code of a block or of an exercise's starter; return its editor."""
    # A draft may open its editor, and hide the <pre>, at any moment.
    place.locator("pre:visible, .cm-content").first.click(position={"x": 40, "y": 20})
    return place.locator(".cm-content")


def write_code(place: Locator, text: str) -> None:
    """Replace the code in a block, or in an exercise's starter, as a reader does."""
    editor = open_editor(place)
    for key in ("Control+a", "Delete"):
        editor.press(key)
    place.page.keyboard.insert_text(text)


def choose(block: Locator, item: str) -> None:
    """Open the menu in the head of a block, and press what it calls `item`."""
    block.locator(".more > summary").click()
    block.locator(".places").get_by_text(item, exact=True).click()


def _url(where: Path | str) -> str:
    return where.resolve().as_uri() if isinstance(where, Path) else where


@contextmanager
def chromium() -> Iterator[Browser]:
    """Yield a running Chromium without a window. Fails the test if none is installed: `make test` installs it."""
    path = next(filter(None, map(shutil.which, NAMES)), None)
    if path is None:
        pytest.fail("There is no Chromium here. Install it: sudo apt-get install chromium")
    arguments = [*ARGUMENTS, "--no-sandbox"] if os.geteuid() == 0 else ARGUMENTS
    expect.set_options(timeout=DEADLINE_MS)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=arguments)
        try:
            yield browser
        finally:
            browser.close()


@contextmanager
def opened(
    browser: Browser | BrowserContext,
    where: Path | str,
    *,
    width: int = 1280,
    height: int = 900,
    dark: bool = False,
) -> Iterator[Opened]:
    """Yield the page at a file's path or a URL, loaded, in a window of `width` pixels.

    In a browser it is the first visit ever. In a context it is not: what was downloaded there is, and nothing else.
    """
    url = _url(where)
    context = browser if isinstance(browser, BrowserContext) else browser.new_context()
    context.set_default_timeout(DEADLINE_MS)
    page = context.new_page()
    try:
        page.set_viewport_size({"width": width, "height": height})
        page.emulate_media(color_scheme="dark" if dark else "light")
        shown = Opened(page)
        _watch(shown, "/".join(url.split("/")[:3]))
        page.goto(url, wait_until="load")
        yield shown
    finally:
        _forget(page) if context is browser else context.close()


def _watch(shown: Opened, origin: str) -> None:
    def hear(message: ConsoleMessage) -> None:
        # Without a graphics card, Chromium itself warns that its pictures are slow.
        if message.type in ("error", "warning") and "GL Driver Message" not in message.text:
            shown.console.append(f"{message.type}: {message.text}")

    def see(request: Request) -> None:
        if not request.url.startswith((*LOCAL, origin)):
            shown.outside.append(request.url)

    shown.page.on("console", hear)
    shown.page.on("pageerror", lambda error: shown.console.append(f"page error: {error}"))
    shown.page.on("request", see)


def _forget(page: Page) -> None:
    """Close the page, and leave nothing that was written in it."""
    page.evaluate("try { localStorage.clear() } catch { /* a test forbids it */ }")
    page.close()
