"""A chapter's open page, cell by cell, in whichever browser: its buttons are pressed, and what cells show is read."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

from firefox import Firefox
from playwright.sync_api import Page

CELLS = "main .cell:is(.cell-node, .cell-shell, .cell-snippet, .cell-interface, .cell-package_file)"
#: How long to wait for a cell (s): the machine may be busy.
DEADLINE_S = 120

_CELL = f"const cell = document.querySelectorAll('{CELLS}')[at];"
_UNTIL = """const until = async (holds, seconds) => {
  const end = Date.now() + 1000 * seconds;
  while (!holds() && Date.now() < end) await new Promise((resolve) => setTimeout(resolve, 20));
  return Boolean(holds());
};"""
_COUNT = f"() => document.querySelectorAll('{CELLS}').length"
_BUTTON = f"""(at) => {{
  {_CELL}
  // What a run shows is an element of its own: this one, if any, is from an earlier run.
  cell.earlier = cell.querySelector('.ran');
  const button = [...cell.querySelectorAll('button')].find((each) => /^Run (?!all)/.test(each.ariaLabel));
  // The page shows the part of the chapter in which it is, as when the browser's search has found it.
  cell.dispatchEvent(new Event('beforematch', {{ bubbles: true }}));
  button.scrollIntoView({{ block: 'center', behavior: 'instant' }});
  return button;
}}"""
_ENDED = f"""(at, seconds) => {{
  {_CELL} {_UNTIL}
  const ran = () => cell.querySelector('.ran');
  return until(() => ran() && ran() !== cell.earlier && !cell.hasAttribute('aria-busy'), seconds);
}}"""
_SHOWS = f"""(at, patterns, seconds) => {{
  {_CELL} {_UNTIL}
  const wanted = patterns.map((pattern) => new RegExp(pattern, 'm'));
  return until(() => wanted.every((each) => each.test(cell.querySelector('.ran pre').textContent)), seconds);
}}"""
_DRAWS = f"""(at, seconds) => {{
  {_CELL} {_UNTIL}
  return until(() => cell.querySelector('.ran figure :is(svg > *, canvas)'), seconds);
}}"""
_SHOWN = f"""(at) => {{
  {_CELL}
  return [cell.querySelector('.ran pre').textContent, Boolean(cell.querySelector('.ran figure :is(svg, canvas)'))];
}}"""
_EVERY = "() => document.querySelector('.running:not([hidden]) button[aria-label=\"Stop all nodes\"]')"
_NONE_RUNS = f"""(seconds) => {{
  {_UNTIL}
  return until(() => document.querySelector('.running')?.hidden ?? true, seconds);
}}"""
_OUTSIDE = """() => performance.getEntriesByType('resource').map((entry) => entry.name)
  .filter((name) => !name.startsWith(location.origin) && !/^(data|blob):/.test(name))"""


class Driver(Protocol):
    """What a browser must be able to do."""

    def call(self, function: str, *given: Any) -> Any:
        """Return what this JavaScript function returns, or resolves to, in the page."""

    def click(self, finder: str, *given: Any) -> None:
        """Click on the element that this JavaScript function returns, as a mouse does."""


@dataclass(frozen=True)
class InChromium:
    """A page that Playwright drives."""

    page: Page

    def call(self, function: str, *given: Any) -> Any:
        """Return what this function returns in the page."""
        return self.page.evaluate(f"(given) => ({function})(...given)", list(given))

    def click(self, finder: str, *given: Any) -> None:
        """Click on the element that this function returns."""
        element = self.page.evaluate_handle(f"(given) => ({finder})(...given)", list(given)).as_element()
        assert element, f"no such element: {given}"
        element.click()


@dataclass(frozen=True)
class InFirefox:
    """A page of a stock Firefox."""

    firefox: Firefox

    def call(self, function: str, *given: Any) -> Any:
        """Return what this function returns in the page."""
        return self.firefox.evaluate(f"return ({function})(...arguments);", *given)

    def click(self, finder: str, *given: Any) -> None:
        """Click on the element that this function returns."""
        self.firefox.click_on(self.call(finder, *given))


@dataclass(frozen=True)
class ChapterPage:
    """The cells of an open page that can run, by their number from 0."""

    driver: Driver

    def count(self) -> int:
        """How many cells there are."""
        return int(self.driver.call(_COUNT))

    def run(self, at: int) -> None:
        """Press a cell's Run, and wait until it has ended, or until its node has started. Raises TimeoutError."""
        self.driver.click(_BUTTON, at)
        if not self.driver.call(_ENDED, at, DEADLINE_S):
            raise TimeoutError(f"cell {at} did not end within {DEADLINE_S} s")

    def wait_for(self, at: int, patterns: list[str], picture: bool, seconds: float) -> None:
        """Wait until a cell shows lines of each pattern, and a picture if one is wanted, but no longer than this."""
        self.driver.call(_SHOWS, at, patterns, seconds)
        if picture:
            self.driver.call(_DRAWS, at, seconds)

    def shown(self, at: int) -> tuple[str, bool]:
        """Return the text that a cell shows now, and whether it shows a picture."""
        text, picture = self.driver.call(_SHOWN, at)
        return text, picture

    def stop_all(self) -> None:
        """Stop every node."""
        if self.driver.call(f"() => Boolean(({_EVERY})())"):
            self.driver.click(_EVERY)
        if not self.driver.call(_NONE_RUNS, DEADLINE_S):
            raise TimeoutError(f"nodes did not end within {DEADLINE_S} s")

    def outside(self) -> list[str]:
        """Return what the page has asked other hosts for."""
        return [str(name) for name in self.driver.call(_OUTSIDE)]
