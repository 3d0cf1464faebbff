"""`%plot` and `%robot` in a page record and draw what they do in a notebook: in a real Chromium."""

from __future__ import annotations

import re
import time
from collections.abc import Iterator

import pytest
from browser import Opened, opened
from playwright.sync_api import BrowserContext, Locator, expect
from test_what_a_page_can_not_do import DEADLINE_MS, run

from ros_in_python.robot.description import description_text
from ros_in_python.robot.drawing import RobotMotion, as_data
from ros_in_python.robot.urdf import read
from spinbook.browser.files import can_run

pytestmark = pytest.mark.skipif(not can_run(), reason="set-up could not fetch Pyodide from npm")

ARM = """\
import math
import rclpy
from sensor_msgs.msg import JointState

rclpy.init()
node = rclpy.create_node('arm')
publisher = node.create_publisher(JointState, 'joint_commands', 10)
angle = 0.0

def move():
    global angle
    angle += 0.1
    publisher.publish(JointState(name=['left_elbow', 'wrist'], position=[math.sin(angle), 1.0], velocity=[0.5, 0.0]))

node.create_timer(0.05, move)
print('moves')
rclpy.spin(node)
"""


@pytest.fixture(scope="module")
def shown(reader: BrowserContext, address: str) -> Iterator[Opened]:
    """A page in which an arm moves."""
    with opened(reader, f"{address}/chapters/01-talk.html") as page:
        expect(run(page.page.locator(".cell-node").first, ARM)).to_contain_text("moves", timeout=DEADLINE_MS)
        yield page


def plotted(shown: Opened, path: str, title: str) -> Locator:
    """Plot in a plain cell and return the plot with this title."""
    cell = shown.page.locator(".cell-snippet").first
    run(cell, f"%plot {path} --seconds 1 --title '{title}'")
    plot = cell.locator(".live-plot svg", has_text=title)
    expect(plot).to_be_visible(timeout=DEADLINE_MS)
    return plot


def test_a_list_is_drawn_with_a_curve_for_each_joint(shown: Opened) -> None:
    plot = plotted(shown, "/joint_commands/position", "Both joints")

    for text in ("position (rad)", "elbow", "wrist"):
        expect(plot).to_contain_text(text)
    assert shown.violations() == []
    assert shown.faults == []


def test_a_whole_message_has_a_panel_for_each_quantity(shown: Opened) -> None:
    expect(plotted(shown, "/joint_commands", "Everything")).to_contain_text("velocity (rad/s)")


def test_an_element_is_one_curve(shown: Opened) -> None:
    plot = plotted(shown, "joint_commands/position[1]", "The wrist only")

    expect(plot.locator("text", has_text="wrist").last).to_be_visible()
    assert plot.locator("text", has_text="elbow").count() == 0


def test_a_robot_moves_and_says_which_joint_is_beyond_its_limits(shown: Opened) -> None:
    cell = shown.page.locator(".cell-snippet").first
    run(cell, "%robot humanoid_description --seconds 90")
    robot = cell.locator("canvas")

    expect(cell.locator(".robot-state")).to_contain_text("left elbow −", timeout=DEADLINE_MS)
    expect(cell.locator(".robot-state")).to_contain_text("(beyond its limits, 0.00 to 2.36)")
    expect(robot).to_have_attribute(
        "aria-label", re.compile(r"^The robot humanoid: left elbow −?[0-9.]+ rad.* keys turn it")
    )
    cell.get_by_role("button", name="Ctrl-C").click()
    expect(cell.get_by_role("status")).to_have_text("done")
    assert shown.violations() == []
    assert shown.faults == []


@pytest.mark.soak
def test_a_recorded_robot_moves_can_be_paused_and_turned_with_the_keys(shown: Opened) -> None:
    motion = RobotMotion((0.0, 0.1, 0.2), {"left_elbow": (0.5, 1.0, 1.5)})
    data = as_data(read(description_text("humanoid_description")), motion)
    shown.page.evaluate("""(data) => {
        const place = document.createElement("figure");
        place.id = "recorded";
        document.querySelector("main h1").after(place);
        moveRobot(place, data);
    }""", data)  # fmt: skip
    robot = shown.page.locator("#recorded")

    expect(robot.locator("canvas")).not_to_have_attribute(
        "aria-label", re.compile("left elbow 0.50"), timeout=DEADLINE_MS
    )
    expect(robot.locator(".robot-state")).to_have_text("All joints are within their limits.")
    robot.get_by_role("button", name="Pause").click()
    expect(robot.get_by_role("button", name="Play")).to_be_visible()
    from_the_front = robot.locator("canvas").screenshot()
    for _ in range(5):
        robot.locator("canvas").press("ArrowLeft")
    end = time.monotonic() + DEADLINE_MS / 1000
    while robot.locator("canvas").screenshot() == from_the_front:
        assert time.monotonic() < end, "the robot does not turn"


def test_what_can_not_be_plotted_is_reported_as_in_a_notebook(shown: Opened) -> None:
    cell = shown.page.locator(".cell-snippet").first

    run(cell, "%plot /joint_commands/positions --seconds 1  # it's a slip")
    expect(cell).to_contain_text("there is no field `positions`. The fields are: header, name", timeout=DEADLINE_MS)
    run(cell, "!ls")
    expect(cell).to_contain_text("a page has no shell", timeout=DEADLINE_MS)
    run(cell, "%ros2 topic ech /joint_commands")
    expect(cell).to_contain_text("Did you mean 'echo'?", timeout=DEADLINE_MS)
    run(cell, "%robot humanoid_descriptoin --seconds 1")
    expect(cell).to_contain_text("no installed package 'humanoid_descriptoin'", timeout=DEADLINE_MS)
    run(cell, "%plot /joint_commands/position[ --seconds 1")
    expect(cell).to_contain_text("is not a field. Write for example position[0]", timeout=DEADLINE_MS)
    run(cell, "%plot /joint_commands --second 1")
    expect(cell).to_contain_text("unrecognized arguments: --second", timeout=DEADLINE_MS)
