"""How long `spinbook build` takes for 100 chapters of 40 cells, and how that compares with jupytext alone.

    python benchmarks/build/chapters.py

Figures of one run on one machine, side by side: start-up (`spinbook --help` with the same imports), a first build, a
rebuild with nothing changed, one chapter changed, and `jupytext --to ipynb` of the same files in one process.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

CHAPTERS = 100
CELLS = 40
RUNS = 5

NODE = '''```python title="node_{c}_{i}.py"
"""A node."""

import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Talker(Node):
    def __init__(self):
        super().__init__("talker")
        self.publisher = self.create_publisher(String, "/chatter", 10)
        self.timer = self.create_timer(0.1, self.talk)

    def talk(self):
        self.publisher.publish(String(data="hello"))


def main():
    rclpy.init()
    rclpy.spin(Talker())


if __name__ == "__main__":
    main()
```
'''
PROSE = """## Section {i} of chapter {c}

A topic carries messages of one type. Whoever subscribes to it hears what is published on it, and knows nothing of who
publishes. See [the next section](#section) for more, and mind **this**.
"""
SNIPPET = "```python\nx_{i} = {i}\nprint(x_{i})\n```\n"
SHELL = "```bash\nros2 topic hz /chatter\n```\n"


def write_course(root: Path) -> None:
    """A course of CHAPTERS chapters, each of CELLS cells: prose, nodes, snippets and shell in turn."""
    (root / "chapters").mkdir()
    names = []
    for c in range(CHAPTERS):
        kinds = [PROSE, NODE, SNIPPET, SHELL]
        cells = [kinds[i % 4].replace("{c}", str(c)).replace("{i}", str(i)) for i in range(CELLS)]
        names.append(f"chapters/c{c:03}.md")
        (root / names[-1]).write_text(f"# Chapter {c}\n\n" + "\n".join(cells))
    listed = ", ".join(f'"{name}"' for name in names)
    (root / "course.toml").write_text(f'title = "Many"\nchapters = [{listed}]\n[package]\nname = "many"\n')


def seconds(*words: str, cwd: Path) -> float:
    """The wall time of one command."""
    start = time.monotonic()
    subprocess.run([sys.executable, *words], cwd=cwd, check=True, stdout=subprocess.DEVNULL)
    return time.monotonic() - start


def main() -> None:
    """Measure and print."""
    start_up, first, rebuild, one_changed, peer = [], [], [], [], []
    for run in range(RUNS):
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            write_course(root)
            start_up.append(seconds("-c", "import spinbook.build.command", cwd=root))
            first.append(seconds("-m", "spinbook", "build", cwd=root))
            rebuild.append(seconds("-m", "spinbook", "build", cwd=root))
            chapter = root / "chapters/c050.md"
            chapter.write_text(chapter.read_text() + f"\nRun {run}.\n")
            one_changed.append(seconds("-m", "spinbook", "build", cwd=root))
            peer.append(
                seconds(
                    "-m", "jupytext", "--quiet", "--to", "ipynb", *map(str, (root / "chapters").glob("*.md")), cwd=root
                )
            )
    base = statistics.median(start_up)
    print(f"{CHAPTERS} chapters of {CELLS} cells; medians of {RUNS} runs (s), and beyond start-up")
    for name, times in (
        ("start-up (imports)", start_up),
        ("first build", first),
        ("nothing changed", rebuild),
        ("one chapter changed", one_changed),
        ("jupytext --to ipynb", peer),
    ):
        middle = statistics.median(times)
        print(f"  {name:<22}{middle:6.2f}  {middle - base:+6.2f}   (min {min(times):.2f}, max {max(times):.2f})")
    print(f"  first build / jupytext: {statistics.median(first) / statistics.median(peer):.2f}")


if __name__ == "__main__":
    main()
