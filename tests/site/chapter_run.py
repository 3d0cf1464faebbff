"""Runs every cell of a chapter's page in order, and compares what each shows with the executed notebook.

    python tests/site/chapter_run.py SITE EXECUTED_NOTEBOOK …

prints the cells that differ. Numbers that depend on time count as equal; what a page's cell shows of something that
goes on for ever must hold every kind of line that was recorded.
"""

from __future__ import annotations

import json
import re
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from playwright.sync_api import Locator, Page

CELLS = "main .cell:is(.cell-node, .cell-shell, .cell-snippet, .cell-interface, .cell-package_file)"
PICTURE = "(a picture)"
_NOT_IN_A_PAGE = ("spinbook-setup", "exercise-")
_ENDLESS = re.compile(
    r"^%%node|^%ros2 .*(topic (echo|hz|bw|delay|pub)|run) |^%log|^%plot|^%turtle|^%graph|^%nodes", re.MULTILINE
)
_NUMBER = re.compile(r"\b([0-9a-f]{2}\.){8,}[0-9a-f]{2}\b|-?(?<![\w.])\d+(\.\d+)?(e[+-]?\d+)?")
_FILE = re.compile(r'File "[^"]*?([^/"<>]+|<[^>]*>)"')
_OF_THE_NOTEBOOK = re.compile(
    r"^— .* —$|^\(restarting .*\)$|^env: |^\.\.\. \(\d+ lines|^~?\^+~?$"
    # A call that is made too early waits, in a notebook as in a page.
    r"|^waiting for service"
)
#: How long to wait for a cell (ms): the machine may be busy.
PATIENCE_MS = 120_000


@dataclass(frozen=True)
class Recorded:
    """A cell of the executed notebook."""

    id: str
    source: str
    lines: tuple[str, ...]
    error: str

    @property
    def endless(self) -> bool:
        """Whether what it shows depends on when one stops looking."""
        return bool(_ENDLESS.search(self.source))

    @property
    def kinds(self) -> set[str]:
        """The kinds of lines that it shows."""
        return set(map(shape, self.lines))


def recorded(notebook: Path) -> list[Recorded]:
    """Return the code cells of an executed notebook that a page can run."""
    cells = json.loads(notebook.read_text(encoding="utf-8"))["cells"]
    return [
        Recorded(cell["id"], "".join(cell["source"]), _lines_of(cell["outputs"]), _error_of(cell["outputs"]))
        for cell in cells
        if cell["cell_type"] == "code" and not cell["id"].startswith(_NOT_IN_A_PAGE) and not _is_only_kept(cell)
    ]


def _is_only_kept(cell: dict[str, Any]) -> bool:
    return bool(re.match(r"%%part .*--keep", "".join(cell["source"])))


def _lines_of(outputs: list[dict[str, Any]]) -> tuple[str, ...]:
    lines: list[str] = []
    for output in outputs:
        data = output.get("data", {})
        if any(kind.startswith("image/") for kind in data):
            lines.append(PICTURE)
        elif output["output_type"] != "error":
            lines += meaningful("".join(output.get("text", "")) + "".join(data.get("text/plain", "")))
    return tuple(lines)


def _error_of(outputs: list[dict[str, Any]]) -> str:
    return next((output["ename"] for output in outputs if output["output_type"] == "error"), "")


def meaningful(text: str) -> list[str]:
    """Return the lines without what only a notebook prints."""
    lines = (line.rstrip() for line in re.sub(r"\x1b\[[0-9;]*m", "", text).splitlines())
    return [line for line in lines if line and not _OF_THE_NOTEBOOK.match(line.strip())]


def shape(line: str) -> str:
    """Return the line without numbers and folders."""
    return _NUMBER.sub("#", _FILE.sub(r'File "\1"', line)).strip()


def run_chapter(page: Page, cells: list[Recorded]) -> dict[str, str]:
    """Run each cell of the open page in order; what differs, by the cell's id."""
    places = page.locator(CELLS)
    assert places.count() == len(cells), f"{places.count()} cells on the page, {len(cells)} in the notebook"
    differences = {}
    for at, cell in enumerate(cells):
        found = _run(page, places.nth(at), cell)
        if found:
            differences[cell.id] = found
    return differences


def _run(page: Page, place: Locator, cell: Recorded) -> str:
    place.get_by_role("button", name=re.compile(r"^Run (?!all)")).click()
    page.wait_for_function(_ENDED, arg=place.element_handle(), timeout=PATIENCE_MS)
    if cell.endless:
        _wait_for_kinds(page, place, cell)
    return compared(cell, shown(place))


_ENDED = "cell => cell.querySelector('.ran') && !cell.hasAttribute('aria-busy')"
_SHOWS = """([cell, wanted, picture]) => {
  const text = cell.querySelector('.ran pre').textContent + (cell.querySelector('.ran figure svg > *') ? picture : '');
  return wanted.every((pattern) => new RegExp(pattern, 'm').test(text));
}"""


def _wait_for_kinds(page: Page, place: Locator, cell: Recorded) -> None:
    """Wait until a line of each recorded kind is there, or the time is up: then it differs."""
    wanted = [_pattern(kind) for kind in cell.kinds]
    try:
        page.wait_for_function(_SHOWS, arg=[place.element_handle(), wanted, PICTURE], timeout=15_000)
    except Exception:
        return


def _pattern(kind: str) -> str:
    return r"-?[0-9a-f][0-9a-f.e+-]*".join(re.escape(part).replace(r"\ ", " ") for part in kind.split("#"))


def shown(place: Locator) -> list[str]:
    """Return what a cell of the page shows now."""
    pictures = place.locator(".ran figure svg").count()
    return [*meaningful(place.locator(".ran pre").text_content() or ""), *([PICTURE] if pictures else [])]


def compared(cell: Recorded, lines: list[str]) -> str:
    """How the lines differ from the recorded ones; "" if they do not."""
    here = [shape(line) for line in lines]
    missing = sorted(cell.kinds - set(here))
    if cell.error and cell.error != "CellFailed" and not any(line.startswith(cell.error) for line in lines):
        missing.append(cell.error)
    more = [] if cell.endless or cell.error else sorted(set(here) - cell.kinds)
    values = _exact(cell) and not cell.error and not more and not missing and lines != list(cell.lines)
    notes = [f"missing: {line}" for line in missing] + [f"more: {line}" for line in more]
    if values:
        pairs = zip(lines, cell.lines, strict=False)
        notes += [f"got {mine!r}, expected {theirs!r}" for mine, theirs in pairs if mine != theirs][:3] or ["order"]
    return "; ".join(notes)


def _exact(cell: Recorded) -> bool:
    """Return whether each number must be the same: plain code, and what only reads files."""
    return not re.search(r"^%", cell.source, re.MULTILINE) or cell.source.startswith("%ros2 interface")


def main(site: Path, notebooks: list[Path]) -> int:
    """Run the chapters' pages and print the differences."""
    sys.path.insert(0, str(Path(__file__).parents[1]))
    from browser import chromium, opened
    from small_course import served

    count = 0
    with served(site) as address, chromium() as browser:
        for notebook in notebooks:
            cells = recorded(notebook)
            with opened(browser, f"{address}/chapters/{notebook.stem}.html") as page:
                found = run_chapter(page.page, cells)
                print(f"{notebook.stem}: {len(cells) - len(found)} of {len(cells)} cells as recorded")
                for name, words in found.items():
                    print(f"  {name}: {words}")
                print("\n".join(page.faults))
            count += len(found)
    return 1 if count else 0


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), [Path(name) for name in sys.argv[2:]]))
