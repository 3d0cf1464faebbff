"""Lines of any length end, are shortened for readers, and are whole in a file; an error is blamed on its own cell."""

from __future__ import annotations

from pathlib import Path

from course_folder import CourseFolder

from spinbook.build.failures import find_failures

CHAPTER = """# Long

```python
print("y" * 1_000_000)
```

```python
list(range(20_000))
```

```python title="camera.py"
print("[INFO] [camera]: " + "z" * 300_000)
```

```python
1 / 0
```
"""


def test_long_lines_are_shortened_and_whole_in_a_file(course: CourseFolder) -> None:
    said = course.write(long=CHAPTER).spinbook("build", "--execute")

    assert "chapters/long.md:16: ZeroDivisionError" in said.stdout
    printed, listed, node, _ = [cell for cell in course.notebook("long", "executed").cells if cell.cell_type == "code"][
        1:
    ]
    assert printed.outputs[0].text.endswith(
        "… 999,500 more characters; the whole line is in long_lines/code-long.txt\n"
    )
    assert "[0,\n 1,\n" in listed.outputs[0].data["text/plain"]
    assert "more characters; the whole line is in long_lines/camera.txt" in node.outputs[0].text
    kept = course.root / "build" / "run" / "long" / "long_lines"
    assert (kept / "code-long.txt").read_text() == "y" * 1_000_000 + "\n"
    assert (kept / "camera.txt").read_text() == "[INFO] [camera]: " + "z" * 300_000 + "\n"


def test_a_run_that_had_to_be_ended_is_blamed_on_the_cell_that_ran() -> None:
    text = {"cell_type": "markdown", "metadata": {"spinbook": {"line": 1}}}
    code = [
        {"cell_type": "code", "source": "", "outputs": [], "metadata": {"spinbook": {"line": line}}} for line in (3, 9)
    ]

    (failure,) = find_failures(Path("a.md"), {"cells": [text, code[0], text, code[1]]}, {"timed_out": 2})

    assert failure.line == 9
