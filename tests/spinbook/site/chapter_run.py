"""Runs every cell of a chapter's page in order, and compares what each shows with the executed notebook.

    python tests/spinbook/site/chapter_run.py SITE EXECUTED_NOTEBOOK RESULTS [--seconds N] [--browser firefox]

appends a line of JSON to RESULTS for each cell, and prints the cells that differ. With --seconds it stops after so
long; the same command then goes on. Numbers that depend on time count as equal; what a page's cell shows of something
that goes on forever must hold every kind of line that was recorded.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

ROOT = Path(__file__).parents[3]
sys.path[:0] = [str(ROOT / "tests" / "support"), str(ROOT / "tests" / "spinbook" / "site")]

from browser import chromium, opened  # noqa: E402
from chapter_page import ChapterPage, InChromium, InFirefox  # noqa: E402
from firefox import firefox  # noqa: E402
from small_course import served  # noqa: E402

PICTURE = "(a picture)"
_NOT_IN_A_PAGE = ("spinbook-setup", "exercise-")
_ENDLESS = re.compile(
    r"^%%node|^%ros2 .*(topic (echo|hz|bw|delay|pub)|run) |^%log|^%plot|^%turtle|^%robot|^%graph|^%nodes", re.MULTILINE
)
_NUMBER = re.compile(r"\b([0-9a-f]{2}\.){8,}[0-9a-f]{2}\b|\b[0-9a-f]{32}\b|-?(?<![\w.])\d+(\.\d+)?(e[+-]?\d+)?")
_FILE = re.compile(r'File "[^"]*?([^/"<>]+|<[^>]*>)"')
_OF_THE_NOTEBOOK = re.compile(
    r"^— .*\s—$|^\(restarting .*\)$|^env: |^\.\.\. \(\d+ lines|^~?\^+~?$"
    # A call that is made too early waits, in a notebook as in a page.
    r"|^waiting for service"
)
#: How long to wait for every kind of line that something endless has shown (s).
SHOWN_S = 15


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


@dataclass(frozen=True)
class Result:
    """What a cell of the page showed, and how that differs from the notebook: nothing if it does not."""

    cell: str
    differs: tuple[str, ...]
    shown: tuple[str, ...]
    seconds: float


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


def run_chapter(page: ChapterPage, cells: list[Recorded], first: int = 0) -> Iterator[Result]:
    """Run each cell of the open page in order, from `first` on, where `beginnings` says that this can be done."""
    assert page.count() == len(cells), f"{page.count()} cells on the page, {len(cells)} in the notebook"
    if first:
        _catch_up(page, [at for at, cell in enumerate(cells[:first]) if _leaves_something(cell)])
    for at, cell in enumerate(cells[first:], first):
        began = time.monotonic()
        lines = _run(page, at, cell)
        yield Result(cell.id, compared(cell, lines), tuple(lines), round(time.monotonic() - began, 1))


def beginnings(cells: list[Recorded]) -> list[int]:
    """Where a run can begin: at the first cell, and after each that stops all nodes."""
    return [0, *(at for at, cell in enumerate(cells, 1) if "%stop --all" in cell.source.splitlines())]


def _leaves_something(cell: Recorded) -> bool:
    """Whether later cells need what this one defines: files, variables, and which program has a name."""
    return not cell.source.startswith(("%", "#")) or cell.source.startswith(("%%", "%env"))


def _catch_up(page: ChapterPage, places: list[int]) -> None:
    """Run these cells without looking at what they show, and stop what they started."""
    for at in places:
        page.run(at)
    page.stop_all()


def _run(page: ChapterPage, at: int, cell: Recorded) -> list[str]:
    page.run(at)
    if cell.endless:
        wanted = [_pattern(kind) for kind in cell.kinds - {PICTURE}]
        page.wait_for(at, wanted, PICTURE in cell.kinds, SHOWN_S)
    return shown(page, at)


def _pattern(kind: str) -> str:
    return r"-?[0-9a-f][0-9a-f.e+-]*".join(re.escape(part).replace(r"\ ", " ") for part in kind.split("#"))


def shown(page: ChapterPage, at: int) -> list[str]:
    """Return what a cell of the page shows now."""
    text, picture = page.shown(at)
    return [*meaningful(text), *([PICTURE] if picture else [])]


def compared(cell: Recorded, lines: list[str]) -> tuple[str, ...]:
    """How the lines differ from the recorded ones, a note for each kind of line; none if they do not."""
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
    return tuple(notes)


def _exact(cell: Recorded) -> bool:
    """Return whether each number must be the same: plain code, and what only reads files."""
    return not re.search(r"^%", cell.source, re.MULTILINE) or cell.source.startswith("%ros2 interface")


def read_results(file: Path) -> dict[str, Result]:
    """The last result of each cell."""
    rows = map(json.loads, file.read_text(encoding="utf-8").splitlines()) if file.exists() else ()
    return {
        row["cell"]: Result(**{**row, "differs": tuple(row["differs"]), "shown": tuple(row["shown"])}) for row in rows
    }


@contextmanager
def page_in(browser: str, url: str) -> Iterator[ChapterPage]:
    """The chapter's page at this address in "chromium" or "firefox"; at the end, print what went wrong in it."""
    if browser == "firefox":
        with TemporaryDirectory() as profile, firefox(Path(profile)) as running:
            running.open(url)
            page = ChapterPage(InFirefox(running))
            yield page
            print("\n".join(f"outside request: {name}" for name in page.outside()))
        return
    with chromium() as playwright, opened(playwright, url) as shown:
        yield ChapterPage(InChromium(shown.page))
        print("\n".join(shown.faults))


def go_on(site: Path, notebook: Path, file: Path, seconds: float, browser: str = "chromium") -> None:
    """Run the cells that have no result yet, for so long, from the last place at which a run can begin."""
    cells, known = recorded(notebook), read_results(file)
    done = next((at for at, cell in enumerate(cells) if cell.id not in known), len(cells))
    if done == len(cells):
        return
    first = max(at for at in beginnings(cells) if at <= done)
    end = time.monotonic() + seconds
    with (
        served(site) as address,
        page_in(browser, f"{address}/chapters/{notebook.stem}.html") as page,
        file.open("a", encoding="utf-8") as results,
    ):
        for result in run_chapter(page, cells, first):
            print(json.dumps(asdict(result), ensure_ascii=False), file=results, flush=True)
            if time.monotonic() > end:
                break


def main() -> int:
    """Read the arguments, run, and print the differences."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("site", type=Path)
    parser.add_argument("notebook", type=Path)
    parser.add_argument("results", type=Path)
    parser.add_argument("--seconds", type=float, default=float("inf"))
    parser.add_argument("--browser", choices=("chromium", "firefox"), default="chromium")
    given = parser.parse_args()
    go_on(given.site, given.notebook, given.results, given.seconds, given.browser)
    cells, found = recorded(given.notebook), read_results(given.results)
    differ = [result for result in found.values() if result.differs]
    print(f"{len(cells)} cells, {len(found)} run, {len(found) - len(differ)} as recorded")
    for result in differ:
        print(f"  {result.cell}: {'; '.join(result.differs)}")
    return 1 if differ or len(found) < len(cells) else 0


if __name__ == "__main__":
    sys.exit(main())
