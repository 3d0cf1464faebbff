"""The real Week 3 chapter, built and run: every cell does what the chapter says about it.

`make soak` runs it, and so does `make course`.
"""

from __future__ import annotations

import re
from typing import Any

import nbformat
import pytest
from executed_chapter import ROOT, executed

NAME = "03-nodes-and-topics"
JOINTS = [f"{side}_{joint}" for side in ("left", "right") for joint in ("shoulder_pitch", "shoulder_roll", "elbow")]

pytestmark = [pytest.mark.soak, pytest.mark.timeout(900)]


@pytest.fixture(scope="module")
def notebook(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """The chapter's notebook with its outputs, made from a copy of the course."""
    return executed(tmp_path_factory.mktemp("course"), NAME)


def cell(notebook: Any, cell_id: str) -> Any:
    return next(cell for cell in notebook.cells if cell.id == cell_id)


def text(notebook: Any, cell_id: str) -> str:
    return "".join(output.get("text", "") for output in cell(notebook, cell_id).outputs)


def pictures(notebook: Any) -> list[Any]:
    outputs = (output for cell in notebook.cells for output in cell.get("outputs", []))
    return [output for output in outputs if "image/svg+xml" in output.get("data", {})]


def test_every_code_cell_ran_and_only_those_that_should_fail_did(notebook: Any) -> None:
    code = [c for c in notebook.cells if c.cell_type == "code"]

    assert len(code) > 40
    assert all(c.execution_count for c in code)
    failed = {c.id for c in code if any(o.output_type == "error" for o in c.outputs)}
    assert failed == {c.id for c in code if "raises-exception" in c.metadata.get("tags", [])}


def test_about_ten_messages_a_second_are_measured(notebook: Any) -> None:
    rates = re.findall(r"average rate: ([\d.]+)", text(notebook, "ros2-topic-hz-joint-commands"))

    assert rates
    assert float(rates[-1]) == pytest.approx(10, rel=0.2)


def test_safety_warnings_name_an_elbow(notebook: Any) -> None:
    assert re.search(
        r"\[WARN\] \[joint_state_monitor\]: SAFETY: (left|right)_elbow", text(notebook, "node-joint-monitor")
    )


def test_six_joints_are_plotted(notebook: Any) -> None:
    plots = [p for p in pictures(notebook) if all(joint in p["data"].get("text/plain", "") for joint in JOINTS)]

    assert plots
    assert all(f">{joint}</text>" in plots[0]["data"]["image/svg+xml"] for joint in JOINTS)


def test_the_turtles_circle_is_shown(notebook: Any) -> None:
    drawn = [output["data"] for output in cell(notebook, "code-drive-a-turtle").outputs if "data" in output]

    assert any("turtle1:" in data.get("image/svg+xml", "") for data in drawn)


def test_the_package_is_built_and_its_executables_run(notebook: Any) -> None:
    assert "1 package finished" in text(notebook, "colcon-build-symlink-install")
    assert "Publishing on /joint_commands" in text(notebook, "ros2-run-humanoid-control-joint-publisher")


def test_the_exercise_is_there_with_task_and_starter(notebook: Any) -> None:
    starter = cell(notebook, "exercise-joint-velocity-starter")

    assert starter.metadata.spinbook.exercise == "joint_velocity"
    assert starter.source.startswith("%%node joint_velocity")
    assert "SOLUTION" not in starter.source


def test_no_folder_of_this_machine_is_in_the_outputs(notebook: Any) -> None:
    assert str(ROOT) not in nbformat.writes(notebook)
