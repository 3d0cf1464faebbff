"""The real Week 5 chapter, built and run: every cell does what the chapter says about it."""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from typing import Any

import nbformat
import pytest
from course_folder import CourseFolder

pytestmark = pytest.mark.soak

ROOT = Path(__file__).parents[2]
NAME = "05-parameters-and-qos"


@pytest.fixture(scope="module")
def notebook(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """The chapter's notebook with its outputs, made from a copy of the course."""
    root = tmp_path_factory.mktemp("course")
    shutil.copy(ROOT / "course.toml", root)
    for folder in ("chapters", "exercises", "solutions"):
        shutil.copytree(ROOT / folder, root / folder)
    said = CourseFolder(root).spinbook("build", "--execute", NAME)
    assert said.returncode == 0, said.stdout + said.stderr
    return nbformat.read(root / "build" / "executed" / f"{NAME}.ipynb", as_version=4)


def shown(notebook: Any, begins: str) -> list[str]:
    """Return what the cells show whose code begins like this, in order."""
    return [
        "".join(output.get("text", "") or output.get("data", {}).get("text/plain", "") for output in cell.outputs)
        for cell in notebook.cells
        if cell.cell_type == "code" and cell.source.startswith(begins)
    ]


def test_every_code_cell_ran_and_only_those_that_should_fail_did(notebook: Any) -> None:
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]

    assert len(code) > 70
    failed = {cell.id for cell in code if any(output.output_type == "error" for output in cell.outputs)}
    assert failed == {cell.id for cell in code if "raises-exception" in cell.metadata.get("tags", [])}


def test_the_plots_show_the_swings_that_the_text_names(notebook: Any) -> None:
    ranges = [re.findall(r"([\d.]+) … ([\d.]+) rad", text) for text in shown(notebook, "%plot")]

    expected = [[(0.7, 1.7)], [(1.0, 1.4)], [(0.9, 1.5), (0.6, 1.8)]]
    found = [[(float(low), float(high)) for low, high in plot] for plot in ranges]
    assert [pytest.approx(one, abs=0.02) for plot in expected for one in plot] == [
        one for plot in found for one in plot
    ]


def test_the_queues_keep_and_age_as_the_text_says(notebook: Any) -> None:
    assert "depth 5 received [16, 17, 18, 19, 20]" in shown(notebook, "%%node burst")[0]
    deep, shallow = (
        float(re.findall(r"([\d.]+) s old", text)[-1])
        for text in (*shown(notebook, "%%node slow_balance"), *shown(notebook, "%ros2 --seconds 40"))
    )
    assert deep > 5 * shallow


def test_the_log_of_the_watch_and_of_the_launch_tell_what_happened(notebook: Any) -> None:
    silent, dead = shown(notebook, "%log tilt_watch")
    assert "deadline missed" in silent
    assert "0 alive, 1 not alive" in dead
    launches = "".join(shown(notebook, "%ros2 --seconds 60"))
    for text in ("process has died", "InvalidParameterTypeException", "amplitude 1.0 rad", "amplitude 0.9 rad"):
        assert text in launches
