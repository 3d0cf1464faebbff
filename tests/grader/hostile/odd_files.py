"""Hostile submissions that are odd as files, and so are made when they are needed: links, odd names, odd bytes."""

from __future__ import annotations

import json
import os
import random
import shutil
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from submissions import HONEST


@dataclass(frozen=True)
class OddFile:
    """A submission to make, and the expected grading.

    Attributes:
        name: its name in test reports.
        make: makes it in a folder and returns the path to submit.
        outcome: see submissions.md; several if more than one is right.
        score: see submissions.md.
        words: what the student must read if it is not graded.
    """

    name: str
    make: Callable[[Path], Path]
    outcome: tuple[str, ...] = ("did-not-start",)
    score: str = "zero"
    words: str = ""


def _named(name: str) -> Callable[[Path], Path]:
    return lambda folder: Path(shutil.copy(HONEST, folder / name))


def _notebook(cells: list[dict[str, object]]) -> str:
    return json.dumps({"cells": cells, "metadata": {}, "nbformat": 4, "nbformat_minor": 5})


def _million_cells(folder: Path) -> Path:
    """Write a valid notebook in which one of a million cells is the node."""
    path = folder / "million.ipynb"
    cell = '{{"cell_type": "code", "id": "c{}", "metadata": {{}}, "source": "x = {}", "outputs": []}}'
    node = json.dumps({"cell_type": "code", "id": "node", "metadata": {}, "source": HONEST.read_text(), "outputs": []})
    with path.open("w") as file:
        file.write('{"cells": [')
        file.writelines(cell.format(n, n) + "," for n in range(999_999))
        file.write(node + '], "metadata": {}, "nbformat": 4, "nbformat_minor": 5}')
    return path


def _symlink_to_a_secret(folder: Path) -> Path:
    """Make a link to a file that the grader may read and the student may not."""
    secret = folder.parent / "secret-of-the-instructor.py"
    secret.write_text("raise SystemExit('the secret is 0.5')\n")
    path = folder / "joint_velocity.py"
    path.symlink_to(secret)
    return path


def _symlink_to_itself(folder: Path) -> Path:
    path = folder / "joint_velocity.py"
    path.symlink_to(path)
    return path


def _device(folder: Path) -> Path:
    path = folder / "joint_velocity.py"
    path.symlink_to("/dev/zero")
    return path


def _pipe(folder: Path) -> Path:
    """Make a pipe without a writer: opening it blocks forever."""
    path = folder / "joint_velocity.py"
    os.mkfifo(path)
    return path


def _folder(folder: Path) -> Path:
    path = folder / "joint_velocity.py"
    path.mkdir()
    return path


def _gigabyte(folder: Path) -> Path:
    """Make a sparse file: a gigabyte to read, nothing on the disk."""
    path = folder / "joint_velocity.py"
    with path.open("wb") as file:
        file.truncate(10**9)
    return path


def _written(name: str, text: str | bytes) -> Callable[[Path], Path]:
    def make(folder: Path) -> Path:
        path = folder / name
        path.write_bytes(text.encode() if isinstance(text, str) else text)
        return path

    return make


def _nested_json(folder: Path) -> Path:
    path = folder / "nested.ipynb"
    path.write_text('{"cells": ' + "[" * 200_000 + "]" * 200_000 + "}")
    return path


ODD_FILES = (
    OddFile("million_cells", _million_cells, ("graded", "did-not-start"), "any"),
    OddFile("symlink_to_a_secret", _symlink_to_a_secret),
    OddFile("symlink_to_itself", _symlink_to_itself),
    OddFile("symlink_to_a_device", _device),
    OddFile("pipe", _pipe),
    OddFile("folder", _folder),
    OddFile("gigabyte", _gigabyte),
    OddFile("nested_json", _nested_json),
    OddFile("notebook_without_cells", _written("empty.ipynb", _notebook([]))),
    OddFile("notebook_that_is_none", _written("broken.ipynb", '{"cells": 7')),
    OddFile("notebook_of_another_kind", _written("odd.ipynb", '["cells", null, {"source": 3}]')),
    OddFile("empty_file", _written("node.py", ""), words="empty"),
    OddFile("binary_rubbish", _written("node.py", random.Random(0).randbytes(4096))),
    OddFile("not_utf8", _written("node.py", "print('größer')".encode("latin-1")), words="utf-8"),
    OddFile("null_bytes", _written("node.py", "print('\0')")),
    OddFile("deeply_nested", _written("node.py", "value = " + "(" * 5000 + ")" * 5000)),
    # Some ways to look for the end of a quotation never finish this line.
    OddFile(
        "a_line_of_backslashes",
        _written("node.py", "# it's " + r"\a" * 30_000 + "\n" + HONEST.read_text()),
        ("graded",),
        "full",
    ),
    OddFile("name_with_spaces", _named("my  node (final) v2.py"), ("graded",), "full"),
    OddFile("name_with_line_break", _named("joint\nvelocity.py"), ("graded",), "full"),
    OddFile("name_with_quotes", _named("'; echo $(id) \"#.py"), ("graded",), "full"),
    OddFile("name_like_an_option", _named("--isolation=none.py"), ("graded",), "full"),
    OddFile("name_in_another_script", _named("関節速度.py"), ("graded",), "full"),
    OddFile("name_of_a_module", _named("rclpy.py"), ("graded", "did-not-start"), "any"),
    OddFile("name_with_terminal_codes", _named("\x1b[2Jnode.py"), ("graded",), "full"),
)
