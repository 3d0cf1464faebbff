"""Checks programs in a real Chromium, all of them in one page's worker, as the exercises' pages do.

    python tests/spinbook/browser/checks_in_chromium.py joint_mover/solution.py heartbeat/right …

A program is named by its path in `solutions/`; a folder stands for all programs in it. Prints a JSON object: path ->
what the page shows. A process of its own, since it uses the course's interfaces.
"""

from __future__ import annotations

import json
import sys
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[3]
SOLUTIONS = ROOT / "solutions"
sys.path[:0] = [str(ROOT / "tests" / "support"), str(ROOT / "tests" / "spinbook" / "site")]

from browser import Opened, chromium, opened  # noqa: E402
from small_course import served  # noqa: E402

from grader.exercise import load  # noqa: E402
from spinbook.browser.files import public_parts, run_files  # noqa: E402
from spinbook.course.course import find_course  # noqa: E402
from spinbook.interfaces.definitions import compile_course  # noqa: E402

_START = """async () => {
  const { take } = await import("./run/processes.js");
  window.heard = [];
  window.worker = take("check", { output: (text) => window.heard.push(text) });
  await window.worker.ready;
}"""
_CHECK = "given => window.worker.call('check.check', given)"


@contextmanager
def page_of(exercises: Iterable[str]) -> Iterator[Opened]:
    """An empty page, beside which everything lies that checks of these exercises need."""
    compile_course(find_course(ROOT))
    with tempfile.TemporaryDirectory() as place, chromium() as browser:
        files: dict[str, str | bytes] = {"index.html": "<!doctype html><title>Checks</title>"}
        files |= run_files(public_parts([load(ROOT / "exercises" / name) for name in exercises]))
        for name, content in files.items():
            file = Path(place, name)
            file.parent.mkdir(exist_ok=True)
            file.write_bytes(content if isinstance(content, bytes) else content.encode())
        with served(Path(place)) as address, opened(browser, f"{address}/index.html") as shown:
            shown.page.evaluate(_START)
            yield shown


def checked(shown: Opened, file: Path) -> dict[str, Any]:
    """What the page's check says of a program."""
    given = {"name": file.relative_to(SOLUTIONS).parts[0], "source": file.read_text(encoding="utf-8")}
    found: dict[str, Any] = shown.page.evaluate(_CHECK, given)
    return found


def programs(path: str) -> list[Path]:
    """The program at a path in `solutions/`, or those in a folder."""
    return [SOLUTIONS / path] if path.endswith(".py") else sorted((SOLUTIONS / path).rglob("*.py"))


def main(paths: list[str]) -> int:
    """Check the programs, and print what the page says of each."""
    files = [file for path in paths for file in programs(path)]
    found: dict[str, dict[str, Any]] = {}
    with page_of(sorted({file.relative_to(SOLUTIONS).parts[0] for file in files})) as shown:
        for file in files:
            name = file.relative_to(SOLUTIONS).as_posix()
            found[name] = checked(shown, file)
            print(f"{name}: {found[name].get('total', found[name])}", file=sys.stderr, flush=True)
    print(json.dumps(found))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
