"""A chapter of a few fences, read as `spinbook build` reads it; for tests."""

from __future__ import annotations

from pathlib import Path

from spinbook.chapter.chapter import Chapter, ChapterCell
from spinbook.chapter.classify import CellKind
from spinbook.chapter.read import ReadResult, read_chapter
from spinbook.chapter.surroundings import Surroundings

IMPORTS = "import rclpy\nfrom rclpy.node import Node\nfrom std_msgs.msg import String\n"
TALKER = "class Talker(Node):\n    def __init__(self):\n        super().__init__('talker')\n"
MAIN = "def main(args=None):\n    rclpy.init(args=args)\n    rclpy.spin(Talker())\n"
GUARD = "if __name__ == '__main__':\n    main()\n"


def reading(tmp_path: Path, *fences: str) -> ReadResult:
    """Return a chapter with these fences; one without an opening line is Python."""
    parts = [fence if fence.startswith("```") else f"```python\n{fence}```\n" for fence in fences]
    (tmp_path / "c.md").write_text("# T\n\n" + "\n".join(parts))
    return read_chapter(tmp_path, Path("c.md"), Surroundings("robot"))


def read(tmp_path: Path, *fences: str) -> Chapter:
    chapter = reading(tmp_path, *fences).chapter
    assert chapter is not None
    return chapter


def cells(chapter: Chapter) -> list[ChapterCell]:
    return [cell for cell in chapter.cells if cell.kind is not CellKind.PROSE]
