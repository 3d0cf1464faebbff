"""The picture of a node graph: what it shows and says, and that it fits into every page."""

from __future__ import annotations

import re
from itertools import combinations
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest
from browser import opened
from hypothesis import given, settings
from hypothesis import strategies as st
from playwright.sync_api import Browser

from spinbook.graph.layout import broken, drawings, layout
from spinbook.graph.model import GraphEndpoint, GraphNode, GraphTopic, NodeGraph
from spinbook.graph.picture import node_graph_svg
from spinbook.site.graph_section import node_graph_html, read_node_graph

JOINTS = "sensor_msgs/msg/JointState"


def end(node: str, kind: str = JOINTS, connected: bool = True) -> GraphEndpoint:
    return GraphEndpoint(node, kind, connected)


def graph_of(*topics: GraphTopic) -> NodeGraph:
    nodes = dict.fromkeys(each.node for topic in topics for each in (*topic.publishers, *topic.subscriptions))
    return NodeGraph(tuple(GraphNode(name) for name in nodes), topics)


ARM = graph_of(
    GraphTopic("/joint_commands", (end("/joint_command_publisher"),), (end("/joint_state_monitor"),), 10.0),
    GraphTopic("/joint_velocities", (end("/joint_velocity", connected=False),), ()),
    GraphTopic("/joint_states", (), (end("/joint_velocity", connected=False), end("/a/long/name/space/of_a_node"))),
)
TURTLE = graph_of(
    GraphTopic("/turtle1/cmd_vel", (end("/turtle_circle"),), (end("/turtlesim"),), 10.0),
    *(GraphTopic(f"/turtle1/{name}", (end("/turtlesim", connected=False),), ()) for name in ("a", "b", "c")),
)


def test_nodes_topics_types_and_rates_are_written() -> None:
    root = ET.fromstring(node_graph_svg(ARM))
    text = "".join(node.text or "" for node in root.iter("{http://www.w3.org/2000/svg}text"))

    for written in ("joint_command_publisher", "/joint_commands", "sensor_msgs/msg/JointState", "10 Hz"):
        assert written in text


def test_it_is_reported_in_words() -> None:
    svg = node_graph_svg(ARM)

    assert "joint_command_publisher publishes /joint_commands (sensor_msgs/msg/JointState, 10 Hz)." in svg
    assert "joint_velocity publishes /joint_velocities (sensor_msgs/msg/JointState) (not connected)." in svg
    assert re.search(r'role="img" aria-labelledby="(\w+)t \1d".*<title id="\1t">.*<desc id="\1d">', svg)


def test_each_connected_part_is_a_picture_of_its_own() -> None:
    assert node_graph_html(ARM).count("<svg ") == 2
    assert node_graph_html(NodeGraph((*ARM.nodes, GraphNode("/alone")), ARM.topics)).count("<svg ") == 3


def test_what_a_node_has_for_itself_alone_is_one_box_where_it_is_much() -> None:
    svg = node_graph_svg(TURTLE)

    assert ">3 topics<" in svg
    assert "<title>3 topics to which no node subscribes: /turtle1/a, /turtle1/b, /turtle1/c</title>" in svg
    assert ">/turtle1/a<" not in svg


def test_an_end_that_is_not_connected_is_dashed() -> None:
    assert node_graph_svg(ARM).count("stroke-dasharray") == 2


def test_names_are_written_as_they_are() -> None:
    ET.fromstring(node_graph_svg(graph_of(GraphTopic("/<b>&", (end("/'\"<i>"),), ()))))


def test_there_is_no_script_no_style_and_nothing_from_outside_in_a_page() -> None:
    html = node_graph_html(TURTLE)

    assert "\n" not in html
    assert not re.search(r"<script|<style|style=|https?://(?!www\.w3\.org/2000/svg)|@import|url\(", html)


_ends = st.lists(st.sampled_from([end(f"/n{number}") for number in range(6)]), max_size=4, unique=True)
_topics = st.lists(st.tuples(_ends, _ends), min_size=1, max_size=7)


@given(_topics)
@settings(max_examples=60, deadline=None)
def test_boxes_never_overlap_and_all_is_within_the_picture(
    topics: list[tuple[list[GraphEndpoint], list[GraphEndpoint]]],
) -> None:
    graph = graph_of(*(GraphTopic(f"/t{n}", tuple(p), tuple(s)) for n, (p, s) in enumerate(topics) if p or s))
    shown = drawings(graph)

    assert sorted(box.name for drawing in shown for box in drawing.nodes) == sorted(node.name for node in graph.nodes)
    for placed in layout(shown):
        for one, other in combinations(placed.boxes, 2):
            apart_x = one.x + one.width <= other.x or other.x + other.width <= one.x
            apart_y = one.y + one.height <= other.y or other.y + other.height <= one.y
            assert apart_x or apart_y
        assert max(box.y + box.height for box in placed.boxes) <= placed.height
        assert max(box.x + box.width for box in placed.boxes) <= placed.width


@given(st.text("ab/_ ", min_size=1, max_size=60))
def test_a_broken_name_loses_nothing_but_spaces(name: str) -> None:
    lines = broken(name, 16)
    assert "".join(lines).replace(" ", "") == name.replace(" ", "")
    assert all(len(line) <= 16 for line in lines)


def test_a_graph_survives_being_kept_as_json(tmp_path: Path) -> None:
    (tmp_path / "a.graph.json").write_text(ARM.to_json())

    assert read_node_graph(tmp_path / "a.graph.json") == ARM
    assert read_node_graph(tmp_path / "missing.graph.json") is None
    for nonsense in ("", "[]", "{}", '{"nodes": [{}], "topics": []}', '{"nodes": [], "topics": [{}]}'):
        (tmp_path / "a.graph.json").write_text(nonsense)
        assert read_node_graph(tmp_path / "a.graph.json") is None


@pytest.mark.parametrize("dark", [False, True])
def test_it_fits_a_phone_with_text_that_can_be_read_and_told(browser: Browser, tmp_path: Path, dark: bool) -> None:
    colours = ("#121212", "#eee") if dark else ("#fff", "#111")
    (tmp_path / "page.html").write_text(
        '<!doctype html><html lang="en"><meta charset="utf-8"><title>Graph</title>'
        '<meta name="viewport" content="width=device-width">'
        '<meta http-equiv="Content-Security-Policy" content="default-src \'self\'">'
        f'<body bgcolor="{colours[0]}" text="{colours[1]}"><main><h1>Graph</h1>{node_graph_html(ARM)}</main>'
    )
    with opened(browser, tmp_path / "page.html", width=390, dark=dark) as shown:
        boxes = shown.page.evaluate(
            "[...document.querySelectorAll('svg g:has(> rect)')].map(g => ["
            "g.querySelector('rect').getBoundingClientRect().toJSON(),"
            "[...g.querySelectorAll('text')].map(t => t.getBoundingClientRect().toJSON())])"
        )
        assert shown.faults == []
        assert shown.violations() == []
        assert not shown.scrolls_sideways()
    assert len(boxes) == len(ARM.nodes) + len(ARM.topics)
    for box, texts in boxes:
        for text in texts:
            assert box["left"] < text["left"] < text["right"] < box["right"]
            assert text["height"] > 9
