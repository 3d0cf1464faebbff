"""A small course with everything that a page can contain, and its site."""

from __future__ import annotations

import os
import shutil
import signal
import socket
import subprocess
import sys
import threading
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

from prepared_python import run_prepared

ROOT = Path(__file__).parents[3]

_COURSE = """\
title = "A small course"
repository = "https://github.com/example/course"
chapters = ["chapters/01-talk.md", "chapters/02-more.md"]
glossary = "chapters/glossary.md"
[package]
name = "small_robot"
workspace = "small_ws"
"""

TALKER = '''\
```python title="talker.py" seconds=20 until="number 3"
"""Talks."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node


class Talker(Node):
    def __init__(self):
        super().__init__('talker')
        self.count = 0
        self.timer = self.create_timer(0.1, self.say)

    def say(self):
        self.count += 1
        self.get_logger().info(f'number {self.count}') if self.count != 2 else self.get_logger().warning('SAFETY: two')


def main():
    rclpy.init()
    node = Talker()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
```
'''

_TALK = f"""\
---
title: Talk
summary: One node that talks.
---

# Talk

A publisher sends messages. Another publisher does so too; see [the next chapter](02-more.md) and the
[task](../exercises/joint_velocity/task.md), or [the course's file](../course.toml).

> [!WARNING]
> Mind the angle $\\omega = \\frac{{v}}{{r}}$.

$$r = \\frac{{v}}{{\\omega}}$$

```mermaid
flowchart LR
    A(["left toe"]) --> T["/left_foot/toe"]
    T --> B(["controller"])
```

<!-- Ask them: is NOTE_OF_THE_CHAPTER a number? -->

## A node

{TALKER}
```python raises
1 / 0
```

## Draw

```python
from IPython.display import display
from ros_in_python.animation import Cycle, on_paper
cycle = Cycle("a", 1.0)
moves = cycle.style(cycle.keyframes("x", [(0.0, "opacity:0"), (1.0, "opacity:1")]))
moving = on_paper(f'{{moves}}<path class="ax" d="M0 9h9"/>', 300, 200, "a", "A curve", "A curve.")
display({{'image/svg+xml': moving, 'text/plain': 'A curve.'}}, raw=True)
```

| Joint | Highest |
| --- | ---: |
| elbow | 2.356 |

<details>
<summary>Answer</summary>

It is forty-two.

</details>

## Practice

<!-- exercise: joint_velocity -->
"""

_MORE = """\
---
title: More
summary: What comes next.
week: 2
---

# More

Words only. <!-- NOTE_IN_A_LINE -->

| Section | Minutes |
| --- | --- |
| [Options](#options) | 20 |
| [Last words](#last-words) | 15 |

## Options

| Option | What colcon does with it | When you need it | Since |
| --- | --- | --- | --- |
| `--symlink-install` | links to your files instead of copies | while you write a package | always |

With `--symlink-install` colcon links, and `--packages-select` builds one: `--symlink-install` and `--packages-select`
save time, `--event-handlers` shows output, and `--symlink-install` once more, with `--packages-up-to` for the rest.

## Last words

**Guess before you look.** How many words does x have?

- None
- One

```python
x = 'word'
```

<details>
<summary>Answer</summary>

**One.** It is "word".

</details>

Good-bye.

Before: [publisher and messages](01-talk.md). No message is lost. This is give–take.
"""
_GLOSSARY = """\
# Glossary

<!--
NOTE_OF_THE_GLOSSARY
-->

## Publisher

Whoever sends.

## Message

What is sent.

## Give–take

A pattern, whose heading is not plain ASCII.
"""


@dataclass(frozen=True)
class SmallCourse:
    """The course's folder, with actions on it."""

    root: Path

    @property
    def site(self) -> Path:
        """Where its site is built."""
        return self.root / "build" / "site"

    @property
    def pages(self) -> list[str]:
        """Every page's path."""
        return sorted(page.relative_to(self.site).as_posix() for page in self.site.rglob("*.html"))

    def page(self, name: str) -> str:
        """Return a page's HTML."""
        return (self.site / name).read_text(encoding="utf-8")

    def change(self, file: str, old: str, new: str) -> None:
        """Replace `old`, which must be there."""
        text = (self.root / file).read_text(encoding="utf-8")
        assert old in text
        (self.root / file).write_text(text.replace(old, new), encoding="utf-8")

    def spinbook_site(self, *words: str) -> subprocess.CompletedProcess[str]:
        """Run `spinbook site` in the course's folder, without access to npm's registry."""
        environment = {**os.environ, "npm_config_registry": "http://127.0.0.1:9"}
        return run_prepared("spinbook", "site", *words, cwd=self.root, env=environment)

    @contextmanager
    def serving(self) -> Iterator[str]:
        """Run `spinbook site --serve`, without running notebooks; yield its address, once it answers."""
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            port = free.getsockname()[1]
        argv = [sys.executable, "-m", "spinbook", "site", "--no-run", "--serve", "--port", str(port)]
        environment = {**os.environ, "npm_config_registry": "http://127.0.0.1:9"}
        process = subprocess.Popen(argv, cwd=self.root, env=environment, start_new_session=True)
        address = f"http://127.0.0.1:{port}"
        try:
            _wait_for(address, process)
            yield address
        finally:
            os.killpg(process.pid, signal.SIGTERM)
            process.wait(60)


def _wait_for(address: str, process: subprocess.Popen[bytes]) -> None:
    deadline = time.monotonic() + 120
    while True:
        try:
            urllib.request.urlopen(address, timeout=10).close()
            return
        except OSError:
            assert process.poll() is None, "it has ended"
            assert time.monotonic() < deadline, "it does not answer"
            time.sleep(0.1)


def write_course(root: Path) -> SmallCourse:
    """Write the course's files, with the real exercise."""
    (root / "chapters").mkdir(parents=True)
    (root / "course.toml").write_text(_COURSE)
    for name, text in (("01-talk", _TALK), ("02-more", _MORE), ("glossary", _GLOSSARY)):
        (root / "chapters" / f"{name}.md").write_text(text, encoding="utf-8")
    for folder in ("exercises", "solutions"):
        shutil.copytree(ROOT / folder / "joint_velocity", root / folder / "joint_velocity")
    with (root / "exercises" / "joint_velocity" / "task.md").open("a", encoding="utf-8") as task:
        task.write("\n<!-- NOTE_OF_THE_TASK: most forget rule 5. -->\n")
    declaration = root / "exercises" / "joint_velocity" / "exercise.toml"
    declaration.write_text(declaration.read_text().replace("points = 100\n", "points = 100\ncount_hints = true\n"))
    return SmallCourse(root)


#: A server's own policy is at least as strict as the one in the pages.
POLICY = (
    "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; connect-src 'self'; style-src 'self'; img-src 'self'; "
    "base-uri 'none'; form-action 'self'; frame-ancestors 'none'"
)


class _Strict(SimpleHTTPRequestHandler):
    def end_headers(self) -> None:
        self.send_header("Content-Security-Policy", POLICY)
        super().end_headers()

    def log_message(self, format: str, *args: object) -> None:
        pass


@contextmanager
def served(folder: Path) -> Iterator[str]:
    """Serve the folder at its own address, from a server that sends a strict Content-Security-Policy."""
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(_Strict, directory=str(folder)))
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    try:
        yield f"http://127.0.0.1:{server.server_port}"
    finally:
        server.shutdown()
        server.server_close()
        thread.join()
