"""What running a page costs: bytes, requests, seconds and memory, in a Chromium without a window.

    python benchmarks/browser/page_figures.py [SITE] [--chapter NAME] [--nodes 1 3 10]

SITE is a built site (build/site). Bytes are counted as a server sends them with gzip. On a machine that does other
things too, the seconds are upper bounds. Memory is the proportional set size of the browser's page processes.
"""

from __future__ import annotations

import argparse
import gzip
import os
import sys
import time
from dataclasses import dataclass
from pathlib import Path

from playwright.sync_api import Browser, BrowserContext, Page, Response

ROOT = Path(__file__).parents[2]
sys.path[:0] = [str(ROOT / "tests" / "support"), str(ROOT / "tests" / "spinbook" / "site")]

from browser import chromium  # noqa: E402
from small_course import served  # noqa: E402

TALKER = """
import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64

class Talker(Node):
    def __init__(self):
        super().__init__("talker_{number}")
        self.publisher = self.create_publisher(Float64, "/talk", 10)
        self.create_timer(0.1, lambda: self.publisher.publish(Float64()))
        self.get_logger().info("ready")

rclpy.init()
rclpy.spin(Talker())
"""
START = """async ([number, source]) => {
  const { take } = await import(new URL("../run/processes.js", location.href));
  const { download } = await import(new URL("../run/download.js", location.href));
  const began = performance.now();
  await download(() => {});
  await new Promise((resolve, reject) => {
    const node = take(`talker_${number}`, { output: (text) => text.includes("ready") && resolve() });
    const ended = (status) => reject(new Error(`talker_${number} ended with ${status}`));
    node.program(source, `talker_${number}.py`).then(ended, reject);
  });
  return (performance.now() - began) / 1000;
}"""


@dataclass(frozen=True)
class Transfer:
    """What a page asked for."""

    requests: int
    megabytes: float


class Watch:
    """Counts what the pages of a context ask for."""

    def __init__(self, context: BrowserContext, site: Path, address: str) -> None:
        self._site, self._address = site, address
        self.paths: list[str] = []
        context.on("response", self._heard)

    def _heard(self, response: Response) -> None:
        """Note what came over the network, and not from the service worker's cache."""
        if not response.from_service_worker:
            self.paths.append(response.url.removeprefix(self._address).split("?")[0])

    def taken(self) -> Transfer:
        """What was asked for since the last call; a file that several ask for is transferred once."""
        files = [self._site / path.lstrip("/") for path in dict.fromkeys(self.paths)]
        self.paths.clear()
        size = sum(len(gzip.compress(file.read_bytes(), 6)) for file in files if file.is_file())
        return Transfer(len(files), size / 1e6)


def memory_mb() -> float:
    """The proportional set size of all processes of page content that this process has started."""
    total = 0
    parents = {folder.name: _parent(folder) for folder in Path("/proc").glob("[0-9]*")}
    for name in parents:
        try:
            if _is_ours(name, parents) and b"--type=renderer" in Path("/proc", name, "cmdline").read_bytes():
                rows = Path("/proc", name, "smaps_rollup").read_text().splitlines()
                total += next(int(row.split()[1]) for row in rows if row.startswith("Pss:"))
        except (OSError, StopIteration):
            continue
    return total / 1e3


def _parent(process: Path) -> str:
    try:
        return (process / "stat").read_text().rpartition(")")[2].split()[1]
    except OSError:
        return ""


def _is_ours(name: str, parents: dict[str, str]) -> bool:
    while name and name != str(os.getpid()):
        name = parents.get(name, "")
    return bool(name)


def start(page: Page, number: int) -> float:
    """Seconds from pressing Run to the node's first log line."""
    return float(page.evaluate(START, [number, TALKER.format(number=number)]))


def measure(browser: Browser, site: Path, address: str, chapter: str, counts: list[int]) -> None:
    """Measure one chapter's page and print the figures."""
    context = browser.new_context()
    watch = Watch(context, site, address)
    page = context.new_page()
    page.goto(f"{address}/chapters/{chapter}.html", wait_until="networkidle")
    print(f"page, before Run:   {watch.taken()}")
    before = memory_mb()
    print(f"first node, cold:   {start(page, 1):.1f} s to its first log line")
    page.wait_for_load_state("networkidle")
    print(f"page, after Run:    {watch.taken()}")
    running = 1
    for count in counts:
        while running < count:
            running += 1
            took = start(page, running)
            if running == 2:
                print(f"a further node:     {took:.1f} s; {watch.taken()}")
        time.sleep(1)  # the last one's garbage is collected meanwhile
        print(f"memory, {count:2} nodes:   {memory_mb() - before:.0f} MB more than before Run")
    page.close()
    page = context.new_page()
    page.goto(f"{address}/chapters/{chapter}.html", wait_until="networkidle")
    print(f"first node, warm:   {start(page, 1):.1f} s to its first log line (second visit)")
    context.close()


def main() -> None:
    """Read the arguments and measure."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("site", type=Path, nargs="?", default=ROOT / "build" / "site")
    parser.add_argument("--chapter", default="03-nodes-and-topics")
    parser.add_argument("--nodes", type=int, nargs="+", default=[1, 3, 10])
    given = parser.parse_args()
    with served(given.site) as address, chromium() as browser:
        measure(browser, given.site, address, given.chapter, given.nodes)


if __name__ == "__main__":
    main()
