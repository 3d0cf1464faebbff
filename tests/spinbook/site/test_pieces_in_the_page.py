"""A page runs what the chapter shows in pieces, with the messages that the chapter defines, in a real Chromium."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from browser import Opened, opened
from course_folder import CourseFolder
from playwright.sync_api import Browser, expect
from small_course import served

from spinbook.browser.files import can_run

pytestmark = pytest.mark.skipif(not can_run(), reason="set-up could not fetch Pyodide from npm")

#: Pyodide starts in a few seconds; on a busy machine, in many.
DEADLINE_MS = 60_000
CHAPTER = """\
# Pieces

```text title="msg/Count.msg"
int64 number 7
```

```python
import rclpy
from rclpy.node import Node
from robot_interfaces.msg import Count
```

```python title="counter.py" seconds=20 until="counted 7"
class Counter(Node):
    def __init__(self):
        super().__init__("counter")
        self.create_subscription(Count, "count", self.heard, 10)
        self.publisher = self.create_publisher(Count, "count", 10)
        self.create_timer(0.1, lambda: self.publisher.publish(Count()))

    def heard(self, count):
        self.get_logger().info(f"counted {count.number}")
```

```bash
ros2 run arm counter_node
```
"""
SETUP = """
```python title="setup.py"
from setuptools import setup

setup(name="arm", entry_points={"console_scripts": ["counter_node = arm.counter:main"]})
```
"""
DEMOS = """
```bash until="World: 2"
ros2 run demo_nodes_cpp talker
```

```bash seconds=20 until="heard"
ros2 run demo_nodes_py listener --ros-args -r __node:=ear
```
"""


@pytest.fixture(scope="module")
def shown(tmp_path_factory: pytest.TempPathFactory, browser: Browser) -> Iterator[Opened]:
    """The page of one chapter, in which all tests run their cells: Pyodide starts once."""
    root = tmp_path_factory.mktemp("course")
    made = CourseFolder(root).write(pieces=CHAPTER + SETUP + DEMOS).spinbook("site", "--strict")
    assert made.returncode == 0, made.stdout + made.stderr
    with served(root / "build" / "site") as address, opened(browser, f"{address}/chapters/pieces.html") as page:
        yield page


def test_a_node_in_pieces_runs_with_the_messages_of_its_chapter(shown: Opened) -> None:
    cell = shown.page.locator(".cell-node")
    cell.get_by_role("button", name="Run counter.py").click()
    expect(cell.get_by_role("log")).to_contain_text("[counter]: counted 7", timeout=DEADLINE_MS)

    shown.page.get_by_role("button", name="Run robot_interfaces/msg/Count.msg").click()
    interface = shown.page.locator(".cell-interface").get_by_role("log")
    expect(interface).to_contain_text("robot_interfaces/msg/Count: ready.", timeout=DEADLINE_MS)

    part = shown.page.locator(".cell-part")
    part.get_by_role("button", name="Run cell 2", exact=True).click()
    expect(shown.page.locator("#said")).to_have_text("cell 2: done", timeout=DEADLINE_MS)

    terminal = shown.page.locator(".cell-shell").first
    terminal.get_by_role("button", name="Run cell 4", exact=True).click()
    expect(terminal.get_by_role("log")).to_contain_text("[counter]: counted 7", timeout=DEADLINE_MS)
    assert shown.violations() == []
    assert shown.faults == []


@pytest.mark.soak
def test_demo_nodes_run_in_a_page(shown: Opened) -> None:
    _, talker, listener = shown.page.locator(".cell-shell").all()
    talker.get_by_role("button", name="Run cell 5", exact=True).click()
    expect(talker.get_by_role("log")).to_contain_text("[talker]: Publishing: 'Hello World: 1'", timeout=DEADLINE_MS)

    listener.get_by_role("button", name="Run cell 6", exact=True).click()
    expect(listener.get_by_role("log")).to_contain_text("[ear]: I heard: [Hello World: ", timeout=DEADLINE_MS)
    assert shown.faults == []
