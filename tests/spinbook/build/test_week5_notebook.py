"""The real Week 5 chapter, built and run: every cell does what the chapter says about it.

`make soak` runs it, and so does `make course`; what its nodes do is in tests/chapters.
"""

from __future__ import annotations

import re
from typing import Any

import pytest
from executed_chapter import executed

NAME = "05-parameters-and-qos"

pytestmark = pytest.mark.soak


@pytest.fixture(scope="module")
def notebook(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """The chapter's notebook with its outputs, made from a copy of the course."""
    return executed(tmp_path_factory.mktemp("course"), NAME)


def shown(notebook: Any, begins: str) -> list[str]:
    """Return what the cells show whose code begins like this, in order."""
    return [
        "".join(output.get("text", "") or output.get("data", {}).get("text/plain", "") for output in cell.outputs)
        for cell in notebook.cells
        if cell.cell_type == "code" and cell.source.startswith(begins)
    ]


def code_of(notebook: Any) -> list[Any]:
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


def failed_unexpectedly(notebook: Any) -> set[str]:
    """Return the cells that failed and should not have, and those that should have and did not."""
    failed = {cell.id for cell in code_of(notebook) if any(output.output_type == "error" for output in cell.outputs)}
    return failed ^ {cell.id for cell in code_of(notebook) if "raises-exception" in cell.metadata.get("tags", [])}


def test_every_code_cell_ran_and_only_those_that_should_fail_did(notebook: Any) -> None:
    assert len(code_of(notebook)) > 70
    assert failed_unexpectedly(notebook) == set()


def test_values_are_refused_where_the_text_says_so(notebook: Any) -> None:
    refused = shown(notebook, "%ros2 --seconds 30 param set")
    assert sum("failed" in text.lower() for text in refused) >= 3


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
