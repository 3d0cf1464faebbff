"""The tree of frames as a picture."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
import yaml
from test_frames import buffer_of, stamped

from ros_in_python.tf2_tools import view_frames

BUFFER = buffer_of(
    stamped("map", "base", 1.0), stamped("map", "base", 2.0), stamped("base", "left"), stamped("base", "right")
)
FRAMES = yaml.safe_load(BUFFER.all_frames_as_yaml())


def test_a_parent_stands_above_the_middle_of_its_children() -> None:
    places = {name: (one.depth, one.across) for name, one in view_frames.places(FRAMES).items()}
    assert places == {"map": (0, 0.5), "base": (1, 0.5), "left": (2, 0.0), "right": (2, 1.0)}


def test_the_graph_says_how_often_each_frame_comes(tmp_path: Path) -> None:
    graph = view_frames.as_graph(FRAMES)
    assert '"map" -> "base"[label="1.0 Hz\\nnewest 2.000 s' in graph
    assert '"base" -> "left"[label="static or sent once"];' in graph
    view_frames.draw(FRAMES, tmp_path / "frames.pdf")
    assert (tmp_path / "frames.pdf").read_bytes().startswith(b"%PDF")


def test_without_matplotlib_the_graph_is_there_and_the_way_to_the_picture(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(SystemExit, match=r"^frames.gv is written. The PDF needs matplotlib: pip install matplotlib$"):
        view_frames.draw(FRAMES, Path("frames.pdf"))
