"""Checks programs of an exercise's solutions in a real Chromium, all of them in one page's worker, as its page does.

    python tests/browser/checks_in_chromium.py EXERCISE [NAME …]

Prints a JSON object: name of the program -> what the page shows. NAME is a file's name without `.py`. A process of its
own, since it uses the course's interfaces.
"""

from __future__ import annotations

import json
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests"), str(ROOT / "tests" / "site")]

from browser import Opened, chromium, opened  # noqa: E402
from small_course import served  # noqa: E402

from grader.exercise import load  # noqa: E402
from spinbook.browser.files import public_parts, run_files  # noqa: E402
from spinbook.course.course import find_course  # noqa: E402
from spinbook.interfaces.compiling import compile_course  # noqa: E402

_START = """async () => {
  const { Process } = await import("./run/processes.js");
  window.heard = [];
  window.worker = new Process("check", { output: (text) => window.heard.push(text) });
  await window.worker.ready;
}"""
_CHECK = "given => window.worker.call('check', given)"


@contextmanager
def page_of(exercise: str) -> Iterator[Opened]:
    """An empty page, beside which everything lies that a check of this exercise needs."""
    compile_course(find_course(ROOT))
    with tempfile.TemporaryDirectory() as place, chromium() as browser:
        files: dict[str, str | bytes] = {"index.html": "<!doctype html><title>Checks</title>"}
        files |= run_files(public_parts([load(ROOT / "exercises" / exercise)]))
        for name, content in files.items():
            file = Path(place, name)
            file.parent.mkdir(exist_ok=True)
            file.write_bytes(content if isinstance(content, bytes) else content.encode())
        with served(Path(place)) as address, opened(browser, f"{address}/index.html") as shown:
            shown.page.evaluate(_START)
            yield shown


def checked(shown: Opened, exercise: str, file: Path) -> dict[str, Any]:
    """What the page's check says of a program."""
    given = {"exercise": exercise, "source": file.read_text(encoding="utf-8")}
    found: dict[str, Any] = shown.page.evaluate(_CHECK, given)
    return found


def main(exercise: str, only: list[str]) -> int:
    """Check the programs, and print what the page says of each."""
    files = sorted(f for f in (ROOT / "solutions" / exercise).rglob("*.py") if not only or f.stem in only)
    found: dict[str, dict[str, Any]] = {}
    with page_of(exercise) as shown:
        for file in files:
            found[file.stem] = checked(shown, exercise, file)
            print(f"{file.stem}: {found[file.stem].get('total', found[file.stem])}", file=sys.stderr, flush=True)
    print(json.dumps(found))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2:]))
