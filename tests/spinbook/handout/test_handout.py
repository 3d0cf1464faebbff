"""`spinbook handout` writes everything students need and nothing that they must not see, the same each time."""

from __future__ import annotations

import ast
import io
import json
import platform
import re
import shutil
import sys
import zipfile
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path
from typing import Any

import pytest
import yaml
from course_folder import CourseFolder

from grader.exercise import load
from grader.exercise.mistakes import Mistake, mistake_of, mistakes_of
from grader.gradescope import own_wheel
from handout.conftest import NOTE, ROOT, HandedOut, append, copy_course, write_small_course
from interface_compiler.wheel_file import zipped
from spinbook.chapter.comments import without_comments
from spinbook.handout.contents import guide_files
from spinbook.handout.leaks import Secret, hidden_names, leaks, secrets
from spinbook.handout.pins import declared_pins, imported_packages, students_pins
from spinbook.handout.student_copy import for_students
from spinbook.handout.wheels import spinbook_wheel

EXERCISE = ROOT / "exercises" / "joint_velocity"
SOLUTIONS = ROOT / "solutions" / "joint_velocity"


def text_of(name: str, content: bytes) -> str:
    """Return a file's text; for JSON, every text or name in it."""
    text = content.decode("utf-8", errors="replace")
    return "\n".join(strings(json.loads(text))) if name.endswith((".ipynb", ".json")) else text


def strings(value: Any) -> Iterator[str]:
    if isinstance(value, dict):
        for key, item in value.items():
            yield from (key, *strings(item))
    elif isinstance(value, list):
        for item in value:
            yield from strings(item)
    elif isinstance(value, str):
        yield value


def secret_texts() -> set[str]:
    """Return hidden checks' names and titles, the solution's own lines, and the docstrings of other solutions."""
    found = {NOTE, "INSTRUCTOR-NOTE"}
    for check in ast.parse((EXERCISE / "hidden_checks.py").read_text(encoding="utf-8")).body:
        if isinstance(check, ast.FunctionDef) and check.name.startswith("test_"):
            found |= {check.name, str(ast.get_docstring(check))}
    solved = False
    for line in (SOLUTIONS / "solution.py").read_text(encoding="utf-8").splitlines():
        if "BEGIN SOLUTION" in line or "END SOLUTION" in line:
            solved = "BEGIN" in line
        elif solved and len(line.strip()) > 45:
            found.add(line.strip())
    for file in SOLUTIONS.glob("right/*.py"):
        found.add(str(ast.get_docstring(ast.parse(file.read_text(encoding="utf-8")))).split("\n")[0])
    for mistake in mistakes_of(load(EXERCISE)):
        found |= {mistake.summary, *(line for line in mistake_lines(mistake) if len(line) > 45)}
    public = (EXERCISE / "checks.py").read_text(encoding="utf-8")
    return {text for text in found if text not in public}


def mistake_lines(mistake: Mistake) -> set[str]:
    """Return the lines of a mistake that the solution does not have."""
    solution = (SOLUTIONS / "solution.py").read_text(encoding="utf-8")
    return {line.strip() for line in mistake.source.splitlines() if line not in solution}


def test_no_file_has_a_solution_a_hidden_check_or_a_note_in_it(real: HandedOut) -> None:
    secrets = secret_texts()
    assert len(secrets) > 40

    names = []
    for name, content in real.files():
        names.append(name)
        text = text_of(name, content)
        assert not [secret for secret in secrets if secret in text], name

    assert len(names) > 200, "the wheel was looked into"
    own = [name for name in names if ".whl/" not in name]
    assert not [name for name in own if "solution" in name or "hidden" in name or name.endswith("scenarios.py")]


def test_public_json_tells_the_public_scenarios_only(real: HandedOut) -> None:
    public = json.loads((real.folder / "exercises" / "joint_velocity" / "public.json").read_text(encoding="utf-8"))

    assert (
        [scenario["name"] for scenario in public["scenarios"]] == list(public["expected"]) == ["chapter", "irregular"]
    )
    hidden = (EXERCISE / "hidden_checks.py").read_text(encoding="utf-8")
    assert public["hidden"]["checks"] == hidden.count("\n@check(")
    assert "seed" not in set(strings(public))


def test_notebooks_have_the_starter_and_the_check_and_no_outputs(real: HandedOut) -> None:
    for file in real.folder.glob("*.ipynb"):
        cells = json.loads(file.read_text(encoding="utf-8"))["cells"]
        assert not [cell["id"] for cell in cells if cell.get("outputs") or cell.get("execution_count")]
    ids = [cell["id"] for cell in cells]
    setup = cells[ids.index("spinbook-setup")]["source"]
    assert "No module named 'spinbook'" in setup, "where nothing is installed, the cell itself says what to do"
    assert setup.split("\n")[-2:] == [
        "%load_ext spinbook",
        "%chapter 03-nodes-and-topics --package humanoid_control --workspace humanoid_ws",
    ]
    starter = ids.index("exercise-joint-velocity-starter")
    assert cells[starter]["source"].startswith("%%node joint_velocity\n")
    assert "TODO" in cells[starter]["source"]
    assert cells[starter + 2]["source"] == "%check joint_velocity"


@pytest.mark.soak
def test_the_same_course_gives_the_same_bytes_wherever_it_lies(real: HandedOut, again: HandedOut) -> None:
    assert again.archive.read_bytes() == real.archive.read_bytes()


def test_folder_and_zip_hold_the_same_and_the_folder_nothing_else(real: HandedOut) -> None:
    outer = f"{real.archive.name}/{real.folder.name}/"
    in_zip = {name.removeprefix(outer): content for name, content in real.files() if ".whl/" not in name}
    in_folder = {
        file.relative_to(real.folder).as_posix(): file.read_bytes() for file in real.folder.rglob("*") if file.is_file()
    }
    assert in_folder == in_zip
    assert not (real.folder / "old").exists()


def test_the_means_to_install_are_there_and_can_be_read(real: HandedOut) -> None:
    readme = (real.folder / "README.md").read_text(encoding="utf-8")
    assert [line for line in readme.splitlines() if line.startswith("## Step")] == [
        "## Step 1: install",
        "## Step 2: open",
        "## Step 3: do the exercises, check, hand in",
    ]
    wheel = next((real.folder / "wheels").glob("spinbook-*.whl"))
    for compiled in ("compiled_interfaces_turtlesim", "rmw_lockstep_prebuilt"):
        [file] = (real.folder / "wheels").glob(f"{compiled}-*.whl")
        line = f'./wheels/{file.name} ; platform_machine == "{platform.machine()}"'
        assert line in (real.folder / "requirements.txt").read_text().splitlines()
    lines = (real.folder / "requirements.txt").read_text().splitlines()
    assert f"./wheels/{wheel.name}" in lines
    names = {line.partition("==")[0] for line in lines if "==" in line}
    assert {"ipykernel", "decorator", "six", "numpy", "ros-rmw-fastrtps-cpp", "colcon-core"} <= names
    assert not {"matplotlib", "pillow", "fonttools"} & names, "nothing in the course imports it"
    lab = {line.partition("==")[0] for line in (real.folder / "jupyterlab.txt").read_text().splitlines()}
    assert {"jupyterlab", "tornado"} - lab == {"tornado"}, "what notebooks have anyway is not named twice"
    assert not (names | lab) & {"sphinx", "mypy", "jedi", "debugpy"}
    conda = yaml.safe_load((real.folder / "environment.yml").read_text())
    assert conda["channels"] == ["robostack-jazzy", "conda-forge"]
    assert {"pip": [f"./wheels/{wheel.name}[notebooks]"]} in conda["dependencies"]
    container = json.loads((real.folder / ".devcontainer" / "devcontainer.json").read_text())
    assert f"./wheels/{wheel.name}[colcon,notebooks,lab]" in container["postCreateCommand"]


def test_packages_that_exercises_declare_are_installed_with_what_they_need() -> None:
    pins = students_pins(b"")
    lines = declared_pins(["rosbags==0.11.9", "numpy==2.3.1"], pins)
    assert {line.partition("==")[0] for line in lines} >= {"rosbags", "lz4"}
    assert not [line for line in lines if line.startswith("numpy")], "it is pinned for each Python"
    assert declared_pins(["rosbags==0.11.9"], []) == ["rosbags==0.11.9"]


@pytest.mark.parametrize(
    ("source", "draws"),
    [
        ("import matplotlib.pyplot as plt\n", True),
        ("def draw():\n    import numpy as np, matplotlib\n", True),
        ("from matplotlib import pyplot\n", True),
        ("%matplotlib inline\ntable.plot()\n", True),
        ("# import matplotlib\nimport numpy  # not matplotlib\n%plot /ticks\n", False),
    ],
)
def test_matplotlib_is_installed_only_if_the_course_imports_it(source: str, draws: bool) -> None:
    packages = imported_packages(["import rclpy, std_msgs.msg, spinbook, grader, IPython\n", source])
    assert packages == ([f"matplotlib=={version('matplotlib')}"] if draws else [])
    more = set(students_pins(b"", packages)) - set(students_pins(b""))
    assert ({"matplotlib", "pillow", "fonttools"} <= {line.partition("==")[0] for line in more}) is draws
    files = guide_files("Robots", "robots", "jazzy", "spinbook.whl", ["a.ipynb"], [], [], packages, b"")
    assert (b"of this course import: matplotlib==" in files["requirements.txt"]) is draws
    assert (b"      - matplotlib==" in files["environment.yml"]) is draws
    assert (b"[colcon,notebooks,lab]' 'matplotlib==" in files[".devcontainer/devcontainer.json"]) is draws


def test_what_cells_import_is_installed_with_what_it_needs() -> None:
    cell = "%%node recorder\nimport rclpy\nfrom rosbags import rosbag2\n"
    packages = imported_packages([cell, "%cd data\nimport yaml, my_own_module\n"])
    assert packages == [f"rosbags=={version('rosbags')}"]
    files = guide_files("Robots", "robots", "jazzy", "spinbook.whl", ["a.ipynb"], [], [], packages, b"")
    assert {b"rosbags", b"lz4"} <= {line.partition(b"==")[0] for line in files["requirements.txt"].splitlines()}
    assert f'"{packages[0]}"'.encode() in files["README.md"]


def test_messages_for_tests_are_installed_only_if_students_read_of_them() -> None:
    lines = set(students_pins(b"from test_msgs.action import Fibonacci")) - set(students_pins(b""))

    assert {line.partition("==")[0] for line in lines} == {"ros-jazzy-test-msgs", "ros-test-msgs"}


def test_the_wheel_holds_every_package_of_ours_that_its_modules_import() -> None:
    name, content = spinbook_wheel()
    assert name.startswith("spinbook-")
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        files = archive.namelist()
        code = "\n".join(archive.read(file).decode() for file in files if file.endswith(".py"))
    imported = set(re.findall(r"^\s*(?:from|import) (\w+)", code, re.MULTILINE))
    ours = {file.parent.name for file in (*ROOT.glob("*/__init__.py"), *ROOT.glob("packages/*/*/__init__.py"))}
    assert imported & ours >= {"spinbook", "grader", "rmw_lockstep"}
    assert {package for package in imported & ours if f"{package}/__init__.py" not in files} == set()


@pytest.fixture
def tiny_checkout(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A checkout of a Spinbook with one file, which is the one that runs, and nothing kept yet."""
    folder = tmp_path / "checkout"
    (folder / "spinbook").mkdir(parents=True)
    (folder / "spinbook" / "__init__.py").write_text("first = 1\n")
    (folder / "pyproject.toml").write_text('[project]\nname = "spinbook"\nversion = "0.1.0"\n')
    monkeypatch.setattr(own_wheel, "SOURCE", folder)
    monkeypatch.setenv("SPINBOOK_CACHE", str(tmp_path / "cache"))
    return folder


def test_the_wheel_is_built_once_and_again_when_a_file_has_changed(
    tiny_checkout: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = spinbook_wheel()
    with monkeypatch.context() as patch:
        patch.setattr(sys, "executable", str(tmp_path / "no-python"))
        assert spinbook_wheel() == first, "nothing is built"

    (tiny_checkout / "spinbook" / "second.py").write_text("second = 2\n")
    with zipfile.ZipFile(io.BytesIO(spinbook_wheel()[1])) as archive:
        assert "spinbook/second.py" in archive.namelist()
    assert len(list((tmp_path / "cache" / "wheels").iterdir())) == 1, "the older one is not kept"


def test_the_students_exercise_is_the_authors_without_what_is_not_for_them(real: HandedOut) -> None:
    copy = real.folder / "exercises" / "joint_velocity"
    theirs, authors = load(copy), load(EXERCISE)

    for part in ("title", "points", "file_name", "class_name", "node_name", "topics"):
        assert getattr(theirs, part) == getattr(authors, part)
    assert (copy / "checks.py").read_bytes() == (EXERCISE / "checks.py").read_bytes()
    task = without_comments((EXERCISE / "task.md").read_text())
    assert (copy / "task.md").read_text(encoding="utf-8").strip() == task.strip()
    assert "<!--" not in task


def test_a_chapter_or_a_task_that_gives_something_away_is_refused(tmp_path: Path) -> None:
    course = write_small_course(tmp_path / "course")
    chapter = course.root / "chapters" / "01-small.md"
    lines = (SOLUTIONS / "solution.py").read_text(encoding="utf-8").split("\n")
    begin = next(i for i, line in enumerate(lines) if "is not None and stamp >" in line)
    append(chapter, "\n```text\n" + "\n".join(lines[begin : begin + 3]) + "\n```\n")
    task = course.root / "exercises" / "joint_velocity" / "task.md"
    append(task, "\nVelocities are right when messages are lost.\n")

    done = course.spinbook("handout")

    assert done.returncode == 1
    assert f"{chapter.stem}.ipynb: error: a part of the solution of joint_velocity would be in it" in done.stderr
    assert re.search(
        r"task\.md:\d+: error: the hidden check test_lost_messages of joint_velocity would be", done.stderr
    )
    assert re.search(r"\(chapters/01-small\.md:\d+, the same as solutions/joint_velocity/solution\.py", done.stderr)
    assert "the same as exercises/joint_velocity/hidden_checks.py:" in done.stderr
    assert "Take it out of the chapter" in done.stderr
    assert "Traceback" not in done.stderr
    assert not (course.root / "build" / "handout").exists()


#: One line of each kind that students must not see.
SECRET_LINES = {
    "a part of the solution": "answer.velocity.append((position - self.positions_before[name]) / dt)",
    "a line of scenarios.py": '"lossy": ("one in three messages is lost", lost(arm_swing(3), 3, seed)),',
    "the hidden check test_lost_messages": "test_lost_messages",
}


@pytest.fixture(scope="module")
def known() -> list[Secret]:
    exercise = load(EXERCISE)
    return [*secrets(exercise, ""), *hidden_names(exercise)]


def notebook_with(place: str, secret: str) -> bytes:
    """Return a notebook that has the secret in one place, and nothing else of note."""
    cell: dict[str, Any] = {"cell_type": "code", "id": "a", "metadata": {}, "source": "x = 1", "outputs": []}
    notebook: dict[str, Any] = {"cells": [cell], "metadata": {}, "nbformat": 4, "nbformat_minor": 5}
    if place == "a stream":
        cell["outputs"] = [{"output_type": "stream", "name": "stdout", "text": ["x\n", f"  {secret}\n"]}]
    elif place == "a picture's text":
        cell["outputs"] = [{"output_type": "display_data", "metadata": {}, "data": {"text/html": f"<b>{secret}</b>"}}]
    elif place == "a traceback":
        cell["outputs"] = [{"output_type": "error", "ename": "E", "evalue": "", "traceback": [secret]}]
    elif place == "a cell's metadata":
        cell["metadata"] = {"editor": {"undo": [{"before": secret}]}}
    elif place == "the notebook's metadata":
        notebook["metadata"] = {"author": {secret: True}}
    elif place == "an attachment":
        cell["attachments"] = {"a.txt": {"text/plain": secret}}
    else:
        cell["source"] = ["x = 1\n", f"    {secret}"]
    return json.dumps(notebook).encode()


@pytest.mark.parametrize("what", SECRET_LINES)
@pytest.mark.parametrize(
    "place",
    [
        "a cell",
        "a stream",
        "a picture's text",
        "a traceback",
        "a cell's metadata",
        "the notebook's metadata",
        "an attachment",
    ],
)
def test_one_line_is_found_wherever_in_a_notebook_it_hides(place: str, what: str, known: list[Secret]) -> None:
    [(name, found)] = leaks({"week3.ipynb": notebook_with(place, SECRET_LINES[what])}, known)
    assert (name, found.startswith(what)) == ("week3.ipynb", True)


@pytest.mark.parametrize("what", SECRET_LINES)
def test_one_line_is_found_in_any_file_and_in_archives_in_archives(what: str, known: list[Secret]) -> None:
    secret = f"x\n\t{SECRET_LINES[what]}\n".encode()
    files = {
        "README.md": secret,
        "public.json": json.dumps({"expected": [SECRET_LINES[what]]}).encode(),
        "wheels/x.whl": zipped({"notes/a.py": secret}),
        "more.zip": zipped({"inner.zip": zipped({"a.txt": secret})}),
    }
    assert {name for name, _ in leaks(files, known)} == {
        "README.md",
        "public.json",
        "wheels/x.whl/notes/a.py",
        "more.zip/inner.zip/a.txt",
    }


def test_a_part_of_a_mistake_is_found_and_so_is_the_text_that_describes_it(known: list[Secret]) -> None:
    lines = mistake_of(load(EXERCISE), "averaged_over_two").source.splitlines()
    begin = next(number for number, line in enumerate(lines) if "velocities_before.get" in line)
    edits = (SOLUTIONS / "mistakes.md").read_text(encoding="utf-8").splitlines()
    begun = edits.index("## averaged_over_two")
    files = {"a.md": "\n".join(lines[begin - 1 : begin + 2]), "b.md": "\n".join(edits[begun : begun + 6])}
    found = list(leaks({name: text.encode() for name, text in files.items()}, known))
    assert found == [(name, "a part of solutions/joint_velocity/mistakes.md") for name in files]


def test_spinbooks_own_modules_may_share_a_line_with_a_check_and_no_part_of_a_solution(known: list[Secret]) -> None:
    line = (EXERCISE / "hidden_checks.py").read_text(encoding="utf-8")
    part = (SOLUTIONS / "solution.py").read_text(encoding="utf-8")

    assert not list(leaks({"wheels/spinbook.whl": zipped({"grader/a.py": line.encode()})}, known))
    assert list(leaks({"wheels/spinbook.whl": zipped({"grader/hidden.py": part.encode()})}, known))
    assert not list(leaks({"site/run/ros.zip": zipped({"rclpy/node.py": part.encode()})}, known)), "everybody has rclpy"
    assert list(leaks({"site/run/check.zip": zipped({"exercises/a/b.py": part.encode()})}, known))


def test_a_file_that_is_named_after_a_hidden_check_is_found(known: list[Secret]) -> None:
    assert list(leaks({"plots/test_lost_messages.png": b""}, known))


def test_what_an_editor_put_into_a_built_notebook_does_not_get_out(tmp_path: Path) -> None:
    course = write_small_course(tmp_path / "course")
    assert course.spinbook("build").returncode == 0
    built = course.root / "build" / "notebooks" / "01-small.ipynb"
    notebook = json.loads(built.read_text(encoding="utf-8"))
    secret = SECRET_LINES["a part of the solution"]
    notebook["metadata"]["note"] = secret
    cell = next(cell for cell in notebook["cells"] if cell["cell_type"] == "code")
    cell["outputs"] = [{"output_type": "stream", "name": "stdout", "text": secret}]
    cell["metadata"]["note"] = secret
    assert secret not in "\n".join(strings(json.loads(for_students(json.dumps(notebook), ""))))

    cell["source"] += f"\n# {secret}"
    built.write_text(json.dumps(notebook), encoding="utf-8")
    done = course.spinbook("handout")
    assert done.returncode == 1
    assert f"{built.name}: error: a part of the solution of joint_velocity would be in it" in done.stderr


def test_a_student_makes_the_same_package_from_the_notebooks_as_the_course_does(
    real: HandedOut, tmp_path: Path
) -> None:
    student = CourseFolder(shutil.copytree(real.folder, tmp_path / "handout"))
    done = student.spinbook("package")
    assert done.returncode == 0, done.stdout + done.stderr
    author = copy_course(tmp_path / "course")
    assert author.spinbook("package").returncode == 0
    theirs, ours = (
        {file.relative_to(root).as_posix(): file.read_bytes() for file in (root / "humanoid_ws").rglob("*.py")}
        for root in (student.root, author.root)
    )
    package = "humanoid_ws/src/humanoid_control"
    assert {name for name in ours if name not in theirs} == set()
    assert [name for name in ours if theirs[name] != ours[name]] == [f"{package}/setup.py"]
    # What the chapters teach, and the student's own exercises.
    assert f"{package}/humanoid_control/joint_velocity.py" in theirs
    assert b"'joint_velocity = humanoid_control.joint_velocity:main'" in theirs[f"{package}/setup.py"]
    (tmp_path / "empty").mkdir()
    refused = CourseFolder(tmp_path / "empty").spinbook("package")
    assert refused.returncode == 1
    assert "no notebook of a course here" in refused.stderr
