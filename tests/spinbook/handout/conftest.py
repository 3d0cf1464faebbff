"""Courses to hand out: a copy of the real one with its author's notes, and a small one for browsers."""

from __future__ import annotations

import io
import re
import shutil
import zipfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import pytest
from course_folder import CourseFolder

ROOT = Path(__file__).parents[3]

#: Is wherever an author may have written what students must not see.
NOTE = "INSTRUCTOR-NOTE-4711"

#: The real course's chapter with the exercise in it.
CHAPTER = "03-nodes-and-topics.md"

#: The exercises of that chapter.
WEEK_3 = ("joint_velocity", "heartbeat", "go_to_goal")

#: The chapters of a course, in its course.toml.
CHAPTERS = re.compile(r"^chapters = \[.*?\]$", re.MULTILINE | re.DOTALL)

SMALL_CHAPTER = f"""# A small chapter

A node that publishes. <!-- {NOTE} -->

```python title="beeper.py"
import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import String


class Beeper(Node):
    def __init__(self):
        super().__init__('beeper')
        self.publisher = self.create_publisher(String, '/beeps', 10)
        self.timer = self.create_timer(0.5, lambda: self.publisher.publish(String(data='beep')))
        self.get_logger().info('Beeping')


def main():
    rclpy.init()
    node = Beeper()
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

## Practice

<!-- exercise: joint_velocity -->
"""


@dataclass(frozen=True)
class HandedOut:
    """A handout: its folder, its zip, and the command's output."""

    folder: Path
    archive: Path
    said: str

    def files(self) -> Iterator[tuple[str, bytes]]:
        """Every file of the zip, those in wheels included, with its content."""
        yield from _within(self.archive.name, self.archive.read_bytes())


def _within(name: str, content: bytes) -> Iterator[tuple[str, bytes]]:
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        for entry in archive.namelist():
            inner = archive.read(entry)
            yield f"{name}/{entry}", inner
            if entry.endswith((".whl", ".zip")):
                yield from _within(f"{name}/{entry}", inner)


def copy_course(root: Path) -> CourseFolder:
    """Make a copy of the real course's Week 3, with its author's notes in every place for them."""
    root.mkdir(parents=True)
    course = (ROOT / "course.toml").read_text(encoding="utf-8")
    (root / "course.toml").write_text(CHAPTERS.sub(f'chapters = ["chapters/{CHAPTER}"]', course), encoding="utf-8")
    shutil.copytree(ROOT / "chapters", root / "chapters", ignore=shutil.ignore_patterns("__pycache__"))
    copy_exercises(root, WEEK_3)
    append(root / "chapters" / CHAPTER, f"\n<!-- {NOTE}\nover two lines -->\n")
    exercise = root / "exercises" / "joint_velocity"
    append(exercise / "task.md", f"\n<!-- {NOTE} -->\n")
    append(exercise / "exercise.toml", f"# {NOTE}\n")
    (exercise / "notes.md").write_text(f"{NOTE}\n")
    return CourseFolder(root)


def copy_exercises(root: Path, names: Sequence[str]) -> None:
    """Copy these exercises of the real course, with their solutions."""
    for folder in ("exercises", "solutions"):
        for name in names:
            ignored = shutil.ignore_patterns("__pycache__")
            shutil.copytree(ROOT / folder / name, root / folder / name, ignore=ignored)


def write_small_course(root: Path) -> CourseFolder:
    """Write a course with one small chapter and the real exercise."""
    course = CourseFolder(root)
    copy_exercises(root, ["joint_velocity"])
    return course.write(**{"01-small": SMALL_CHAPTER})


def append(file: Path, text: str) -> None:
    """Add `text` at the end of `file`."""
    file.write_text(file.read_text(encoding="utf-8") + text, encoding="utf-8")


def hand_out(course: CourseFolder) -> HandedOut:
    """Run `spinbook handout`, which must succeed."""
    done = course.spinbook_from_scratch("handout")
    assert done.returncode == 0, done.stdout + done.stderr
    folder = next(path for path in (course.root / "build" / "handout").iterdir() if path.is_dir())
    return HandedOut(folder, folder.with_suffix(".zip"), done.stdout)


@pytest.fixture(scope="session")
def real(tmp_path_factory: pytest.TempPathFactory) -> HandedOut:
    """The handout of the real course, made over an older one."""
    course = copy_course(tmp_path_factory.mktemp("real") / "course")
    left = course.root / "build" / "handout" / "humanoid-robotics-with-ros-2" / "old" / "notebook.ipynb"
    left.parent.mkdir(parents=True)
    left.write_text("{}")
    return hand_out(course)


@pytest.fixture(scope="session")
def again(tmp_path_factory: pytest.TempPathFactory) -> HandedOut:
    """The same course's handout, made in another folder, with the solution run again."""
    course = copy_course(tmp_path_factory.mktemp("again") / "another" / "place")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SPINBOOK_CACHE", str(tmp_path_factory.mktemp("cache")))
        return hand_out(course)


@pytest.fixture(scope="session")
def small_course(tmp_path_factory: pytest.TempPathFactory) -> CourseFolder:
    """A course with one small chapter and the real exercise."""
    return write_small_course(tmp_path_factory.mktemp("small") / "course")


@pytest.fixture(scope="session")
def small(small_course: CourseFolder) -> HandedOut:
    """The small course's handout."""
    return hand_out(small_course)


def solution() -> str:
    """The author's solution."""
    return (ROOT / "solutions" / "joint_velocity" / "solution.py").read_text(encoding="utf-8")
