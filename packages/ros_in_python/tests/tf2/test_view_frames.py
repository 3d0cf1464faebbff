"""The tree of frames as a picture."""

from __future__ import annotations

from xml.etree import ElementTree as ET

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


def test_the_graph_and_the_picture_say_how_often_each_frame_comes() -> None:
    graph = view_frames.as_graph(FRAMES)
    assert '"map" -> "base"[label="1.0 Hz\\nnewest 2.000 s' in graph
    assert '"base" -> "left"[label="static or sent once"];' in graph

    picture = ET.fromstring(view_frames.as_svg(FRAMES))
    texts = [node.text for node in picture.iter() if node.tag.endswith(("}text", "}tspan")) and node.text]
    assert texts == [
        "1.0 Hz",
        "newest 2.000 s",
        "1.000 s kept",
        *["static or sent once"] * 2,
        *view_frames.places(FRAMES),
    ]
    boxes = [node for node in picture.iter() if node.get("rx") == "8"]
    edges = [(float(box.attrib["x"]), float(box.attrib["x"]) + float(box.attrib["width"])) for box in boxes]
    assert all(0 < left < right < float(picture.attrib["width"]) for left, right in edges)


def test_names_of_frames_are_text() -> None:
    frames = yaml.safe_load(buffer_of(stamped("a<b", "c&d")).all_frames_as_yaml())
    texts = [node.text for node in ET.fromstring(view_frames.as_svg(frames)).iter() if node.tag.endswith("}text")]
    assert sorted(filter(None, texts)) == ["a<b", "c&d"]


def test_frames_that_are_each_others_parents_are_all_in_the_picture() -> None:
    pairs = (("arm", "hand"), ("hand", "arm"), ("arm", "tool"), ("map", "base"))
    frames = yaml.safe_load(buffer_of(*(stamped(parent, child) for parent, child in pairs)).all_frames_as_yaml())
    places = {name: (one.depth, one.across) for name, one in view_frames.places(frames).items()}
    assert places == {"map": (0, 0.0), "base": (1, 0.0), "arm": (0, 1.5), "hand": (1, 1.0), "tool": (1, 2.0)}
    ET.fromstring(view_frames.as_svg(frames))
