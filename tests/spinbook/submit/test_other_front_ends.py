"""`%check` as VS Code and Colab run it: another folder, no widgets, cells in any order, a restarted kernel."""

from __future__ import annotations

import json
import os
import re
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from notebook_kernel import Kernel

from grader.exercise import starter
from spinbook.kernel.check_cell import JUPYTER, VS_CODE
from submit.conftest import node_cell, solution
from submit.test_check_cell import texts

#: As on a machine without ipywidgets and ipympl.
NO_WIDGETS = "import sys\nsys.modules['ipywidgets'] = sys.modules['ipympl'] = None"

#: What is asked here is printed before the check begins, which then ends at once.
BEGUN = "%check joint_velocity --seconds 0.05"


def save(notebook: Path, code: str) -> None:
    """Save a notebook with the exercise's cell in it."""
    cell = {"cell_type": "code", "source": node_cell(code), "metadata": {"spinbook": {"exercise": "joint_velocity"}}}
    check = {"cell_type": "code", "id": "checked", "source": "%check joint_velocity", "metadata": {}}
    notebook.write_text(json.dumps({"cells": [cell, check], "metadata": {}, "nbformat": 4, "nbformat_minor": 5}))


@pytest.fixture(scope="module")
def place(handed_out: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the exercises in it, and a saved notebook with the starter."""
    folder = tmp_path_factory.mktemp("front") / "course"
    shutil.copytree(handed_out, folder)
    save(folder / "week3.ipynb", starter(solution()))
    return folder


@pytest.fixture(scope="module")
def elsewhere(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Kernel]:
    """A kernel in a folder that has nothing to do with the course, and no widgets."""
    kernel = Kernel(tmp_path_factory.mktemp("elsewhere"), **{JUPYTER: ""})
    assert not kernel.run(NO_WIDGETS).error
    yield kernel
    kernel.shut_down()


def test_colab_a_notebook_alone_is_told_what_it_lacks_and_works_once_it_has_it(elsewhere: Kernel, place: Path) -> None:
    elsewhere.run(node_cell(solution()))
    shown = elsewhere.run("%check joint_velocity")
    assert "There is no exercise 'joint_velocity' here" in shown.error
    assert "from the course's website: run its first code cells" in shown.error
    assert "keep the notebook in the folder of the handout" in shown.error
    assert "%check joint_velocity --course FOLDER" in shown.error
    assert "Traceback" not in shown.error

    text, _ = texts(elsewhere.run(f"%check joint_velocity --course {place}"))
    assert "Next: hand in." in text


def test_vs_code_the_notebooks_own_folder_counts_and_the_saved_cell_where_none_was_run(
    elsewhere: Kernel, place: Path
) -> None:
    notebook = place / "week3.ipynb"
    # What a restart leaves of a session: only what is on the disk.
    elsewhere.run("get_ipython().spinbook_session.ran.clear()")
    elsewhere.run(f"{VS_CODE} = {os.fspath(notebook)!r}")

    shown = elsewhere.run("%check joint_velocity")

    assert "it has not been run since the kernel started, so this is how it was last saved in week3" in shown.text
    assert "0 of 41 points" in texts(shown)[0]


def test_a_cell_that_was_changed_since_it_was_run_is_reported_and_one_that_was_not_saved_yet_is_not(
    elsewhere: Kernel, place: Path
) -> None:
    elsewhere.run(f"{VS_CODE} = {os.fspath(place / 'week3.ipynb')!r}")
    elsewhere.run(node_cell("raise SystemExit"))
    said = elsewhere.run(BEGUN).text
    assert re.search(r"Checked: the cell %%node joint_velocity as you ran it at \d\d:\d\d:\d\d, without", said)
    assert "WARNING" not in said

    save(place / "week3.ipynb", solution())
    shown = elsewhere.run(BEGUN)

    assert "WARNING: You have changed the cell %%node joint_velocity since you ran it" in shown.text
    assert "Run that cell again, then %check joint_velocity." in shown.text

    (place / "week3.ipynb").rename(place / "mine.ipynb")
    (place / "a.ipynb").symlink_to("gone.ipynb")
    elsewhere.from_cell("checked")
    assert "WARNING: You have changed the cell" in elsewhere.run(f"{BEGUN} --course {place}").text

    (place / "a copy.ipynb").write_bytes((place / "mine.ipynb").read_bytes())
    assert "WARNING" not in elsewhere.run(f"{BEGUN} --course {place}").text, "which of the two runs is not known"


def test_a_restarted_kernel_needs_only_the_first_cell_and_then_any_cell_may_come_first(place: Path) -> None:
    kernel = Kernel(place, **{JUPYTER: ""})
    try:
        shown = kernel.run("%check joint_velocity")
        assert shown.error == "Run the cell that begins with %%node joint_velocity first. Then run this one again."
        assert not kernel.run(f"%cd -q {place.parent}").error
        kernel.run(node_cell(solution()))
        assert not kernel.run(f"%cd -q {place / 'exercises'}").error
        assert "was stopped" in kernel.run(BEGUN).error, "it has begun: a folder within the course will do"
    finally:
        kernel.shut_down()
