"""The node on real DDS: as processes, from the outside, as a student meets it."""

from __future__ import annotations

import json
import math
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
import rclpy
from action_msgs.msg import GoalStatus
from geometry_msgs.msg import Twist
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import SetParameters
from rclpy.action import ActionClient
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from rclpy.signals import SignalHandlerOptions
from rosgraph_msgs.msg import Clock
from std_msgs.msg import String
from std_srvs.srv import Empty, Trigger
from turtle_oracle import circle
from turtlesim.action import RotateAbsolute
from turtlesim.msg import Color, Pose
from turtlesim.srv import Kill, SetPen, Spawn, TeleportAbsolute, TeleportRelative

from ros_in_python.turtlesim.events import CENTRE
from ros_in_python.turtlesim.picture import NoPictureError, fetch

DEADLINE_S = 60.0


class Running:
    """One of our processes, its log so far, and its end."""

    def __init__(self, module: str, *arguments: str) -> None:
        command = [sys.executable, "-m", f"ros_in_python.turtlesim.{module}", *arguments]
        environment = {**os.environ, "RCUTILS_CONSOLE_OUTPUT_FORMAT": "[{severity}] [{name}]: {message}"}
        self.process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True, env=environment)
        self.log: list[str] = []
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def _read(self) -> None:
        assert self.process.stderr is not None
        self.log += []
        for line in self.process.stderr:
            self.log.append(line.rstrip("\n"))

    def end(self, how: signal.Signals) -> int:
        """Send a signal and wait; return the exit code."""
        self.process.send_signal(how)
        code = self.process.wait(timeout=DEADLINE_S)
        self._reader.join()
        return code


@contextmanager
def running(module: str, *arguments: str) -> Iterator[Running]:
    started = Running(module, *arguments)
    try:
        yield started
    finally:
        started.process.kill()
        started.process.wait()


class Outside:
    """The test's own node, and what it has received."""

    def __init__(self) -> None:
        self._context = Context()
        rclpy.init(context=self._context, signal_handler_options=SignalHandlerOptions.NO)
        self.node = Node("outside", context=self._context, use_global_arguments=False)
        self._executor = SingleThreadedExecutor(context=self._context)
        self._executor.add_node(self.node)
        self._publishers: dict[str, Any] = {}
        self._clients: list[ActionClient] = []

    def close(self) -> None:
        self._executor.shutdown()
        for client in self._clients:  # rclpy's destroy_node leaves them, and with them the node in its ROS domain
            client.destroy()
        self.node.destroy_node()
        self._context.try_shutdown()

    def until(self, condition: Callable[[], bool], what: str) -> None:
        """Spin until the condition holds."""
        end = time.monotonic() + DEADLINE_S
        while not condition():
            assert time.monotonic() < end, f"never: {what}"
            self._executor.spin_once(timeout_sec=0.05)

    def moment(self) -> None:
        """Spin until something arrives, for 0.1 s at most."""
        self._executor.spin_once(timeout_sec=0.1)

    def hear(self, kind: type, topic: str) -> list[Any]:
        """Return a list to which everything on a topic is added."""
        heard: list[Any] = []
        self.node.create_subscription(kind, topic, heard.append, 100)
        return heard

    def action_client(self, kind: Any, name: str) -> ActionClient:
        """Return a client for an action, which ends with this node."""
        self._clients.append(ActionClient(self.node, kind, name))
        return self._clients[-1]

    def say(self, topic: str, message: Any) -> None:
        """Publish once, when there is a subscriber."""
        if topic not in self._publishers:
            self._publishers[topic] = self.node.create_publisher(type(message), topic, 10)
        publisher = self._publishers[topic]
        self.until(lambda: publisher.get_subscription_count() > 0, f"a subscriber of {topic}")
        publisher.publish(message)

    def call(self, kind: type, name: str, request: Any = None) -> Any:
        """Call a service and wait for the answer."""
        client = self.node.create_client(kind, name)
        self.until(client.service_is_ready, f"the service {name}")
        answer = client.call_async(request or kind.Request())  # type: ignore[attr-defined]
        self.until(answer.done, f"an answer of {name}")
        return answer.result()

    def set_integer(self, name: str, value: int) -> Any:
        """Set a parameter of the node; return its answer."""
        wanted = ParameterValue(type=ParameterType.PARAMETER_INTEGER, integer_value=value)
        request = SetParameters.Request(parameters=[Parameter(name=name, value=wanted)])
        return self.call(SetParameters, "/turtlesim/set_parameters", request).results[0]

    def picture(self) -> Any:
        """Return what /turtlesim/picture contains."""
        answer = self.call(Trigger, "/turtlesim/picture")
        assert answer.success
        return json.loads(answer.message)


@pytest.fixture
def outside(ros_domain: int) -> Iterator[Outside]:
    """A node in a domain of the test's own."""
    outside = Outside()
    yield outside
    outside.close()


@pytest.fixture
def turtlesim(outside: Outside) -> Iterator[Running]:
    """The node turtlesim in the same domain."""
    with running("node") as node:
        yield node


def turn(forward: float, turning: float) -> Twist:
    twist = Twist()
    twist.linear.x, twist.angular.z = forward, turning
    return twist


def test_the_log_begins_as_turtlesim_s(turtlesim: Running, outside: Outside) -> None:
    outside.picture()
    outside.until(lambda: len(turtlesim.log) >= 2, "two lines of log")
    assert turtlesim.log == [
        "[INFO] [turtlesim]: Starting turtlesim with node name /turtlesim",
        "[INFO] [turtlesim]: Spawning turtle [turtle1] at x=[5.544445], y=[5.544445], theta=[0.000000]",
    ]


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
def test_the_node_ends_in_order_when_told_to(turtlesim: Running, outside: Outside, how: signal.Signals) -> None:
    outside.picture()
    assert turtlesim.end(how) == 0
    assert len(turtlesim.log) == 2, turtlesim.log


ENDS_WHILE_PUBLISHING = """
import os, signal, sys, time
from rclpy.node import Node
from std_msgs.msg import String
from ros_in_python.spinning import spin_until_stopped

def make():
    node = Node("ending")
    publisher = node.create_publisher(String, "last_words", 1)

    def work():
        os.kill(os.getpid(), signal.{how})
        # Long enough for any other thread to shut the context down, were there one that does.
        time.sleep(0.3)
        publisher.publish(String(data="done"))
        print("published")

    node.create_timer(0.01, work)
    return node

sys.exit(spin_until_stopped(make))
"""


@pytest.mark.parametrize("how", ["SIGINT", "SIGTERM"])
def test_a_signal_lets_the_callback_at_hand_finish(ros_domain: int, how: str) -> None:
    script = ENDS_WHILE_PUBLISHING.replace("{how}", how)
    ended = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, timeout=DEADLINE_S)
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, "published\n", "")


def test_one_command_drives_an_arc_for_a_second(turtlesim: Running, outside: Outside) -> None:
    poses = outside.hear(Pose, "/turtle1/pose")
    outside.until(lambda: len(poses) > 5, "some poses")
    outside.say("/turtle1/cmd_vel", turn(2.0, 1.0))
    outside.until(lambda: poses[-1].theta > 0 and poses[-1] == poses[-5], "the end of the drive")
    last = poses[-1]
    # 62 or 63 ticks, depending on when the command arrives; fewer if the machine is too busy for 62 in a second.
    ticks = round(last.theta / 0.016)
    place, heading = circle(ticks, 2.0, 1.0, complex(CENTRE, CENTRE), 0.0)
    assert 0 < ticks <= 63
    assert (last.x, last.y, last.theta) == pytest.approx((place.real, place.imag, heading), abs=1e-5)


def test_a_circle_is_a_circle(turtlesim: Running, outside: Outside) -> None:
    poses = outside.hear(Pose, "/turtle1/pose")
    outside.until(lambda: len(poses) > 0, "a pose")
    while len(poses) < 150:
        outside.say("/turtle1/cmd_vel", turn(2.0, 1.0))
        before = len(poses)
        outside.until(lambda before=before: len(poses) > before + 5, "further poses")  # type: ignore[misc]
    moving = [pose for pose in poses if pose.theta != 0.0]
    # Chords of a circle of radius v/w around the point to the left of the start (half a tick askew).
    radii = [math.dist((pose.x, pose.y), (CENTRE, CENTRE + 2.0)) for pose in moving]
    assert radii == [pytest.approx(2.0, abs=0.04)] * len(radii)


def test_the_picture_tells_the_world(turtlesim: Running, outside: Outside) -> None:
    outside.call(TeleportAbsolute, "/turtle1/teleport_absolute", TeleportAbsolute.Request(x=2.0, y=3.0, theta=1.0))
    outside.until(lambda: outside.picture()["turtles"][0]["x"] == 2.0, "the teleport")
    picture = outside.picture()
    (stroke,) = picture["trails"]
    assert stroke["points"] == [[5.5444, 5.5444], [2.0, 3.0]]
    assert picture["background"] == [69, 86, 255]
    outside.call(Empty, "/clear")
    assert outside.picture()["trails"] == []
    outside.call(Empty, "/reset")
    assert outside.picture()["turtles"][0]["x"] == 5.5444
    assert turtlesim.log[2] == "[INFO] [turtlesim]: Clearing turtlesim."
    assert turtlesim.log[3] == "[INFO] [turtlesim]: Resetting turtlesim."


def test_the_background_is_a_parameter_from_0_to_255(turtlesim: Running, outside: Outside) -> None:
    assert outside.set_integer("background_r", 255).successful
    assert outside.picture()["background"] == [255, 86, 255]
    for value in (-1, 256):
        refusal = outside.set_integer("background_g", value)
        assert not refusal.successful
        assert "range" in refusal.reason
    assert outside.picture()["background"] == [255, 86, 255]


def test_turtles_are_spawned_with_a_pen_and_killed(turtlesim: Running, outside: Outside) -> None:
    poses = outside.hear(Pose, "/bob/pose")
    colors = outside.hear(Color, "/bob/color_sensor")
    request = Spawn.Request(x=2.0, y=3.0, theta=0.5, name="bob")
    assert outside.call(Spawn, "/spawn", request).name == "bob"
    outside.until(lambda: len(poses) > 0 and len(colors) > 0, "bob's poses and colours")
    assert (poses[-1].x, poses[-1].y, poses[-1].theta) == pytest.approx((2, 3, 0.5), abs=1e-6)
    assert colors[-1] == Color(r=255, g=255, b=255)
    outside.call(SetPen, "/bob/set_pen", SetPen.Request(r=255, g=51, b=0, width=9))
    outside.call(TeleportRelative, "/bob/teleport_relative", TeleportRelative.Request(linear=1.0, angular=math.pi))
    outside.until(lambda: colors[-1].b == 0, "the pen's colour under bob")
    assert colors[-1] == Color(r=255, g=51, b=0)
    outside.call(Kill, "/kill", Kill.Request(name="bob"))
    outside.until(lambda: not outside.node.get_publishers_info_by_topic("/bob/pose"), "the end of bob's topics")
    assert [turtle["name"] for turtle in outside.picture()["turtles"]] == ["turtle1"]


def test_a_name_that_is_taken_or_unknown_is_reported_in_the_log(turtlesim: Running, outside: Outside) -> None:
    assert outside.call(Spawn, "/spawn").name == "turtle2"
    assert outside.call(Spawn, "/spawn", Spawn.Request(name="turtle2")).name == ""
    outside.call(Kill, "/kill", Kill.Request(name="eve"))
    outside.until(lambda: len(turtlesim.log) >= 5, "two lines about them")
    assert turtlesim.log[3:] == [
        "[ERROR] [turtlesim]: A turtle named [turtle2] already exists. "
        "Choose another name, or call /kill with this one first.",
        "[ERROR] [turtlesim]: Tried to kill turtle [eve], which does not exist. Turtles that do: turtle1, turtle2.",
    ]


def rotate(outside: Outside, theta: float, remaining: list[float]) -> Any:
    """Return the handle of an accepted goal, whose feedback goes into `remaining`."""
    client = outside.action_client(RotateAbsolute, "/turtle1/rotate_absolute")
    outside.until(client.server_is_ready, "the action")
    goal = client.send_goal_async(
        RotateAbsolute.Goal(theta=theta), feedback_callback=lambda arrived: remaining.append(arrived.feedback.remaining)
    )
    outside.until(goal.done, "the goal's acceptance")
    assert goal.result().accepted
    return goal.result()


def ended(outside: Outside, goal: Any) -> Any:
    result = goal.get_result_async()
    outside.until(result.done, "the goal's end")
    return result.result()


def test_a_rotation_tells_what_remains_and_how_it_ended(turtlesim: Running, outside: Outside) -> None:
    remaining: list[float] = []
    first = ended(outside, rotate(outside, 1.0, remaining))
    assert first.status == GoalStatus.STATUS_SUCCEEDED
    assert first.result.delta == pytest.approx(-0.992, abs=1e-6)
    outside.until(lambda: remaining[-1:] == [pytest.approx(0.008, abs=1e-6)], "the last feedback")
    second = rotate(outside, -2.0, remaining)
    outside.until(lambda: remaining[-1] < -1.0, "the second rotation")
    cancelled = second.cancel_goal_async()
    outside.until(cancelled.done, "the answer to cancelling")
    assert ended(outside, second).status == GoalStatus.STATUS_CANCELED
    outside.until(lambda: len(turtlesim.log) > 3, "the second rotation's line in the log")
    assert turtlesim.log[2:] == [
        "[INFO] [turtlesim]: Rotation goal completed successfully",
        "[INFO] [turtlesim]: Rotation goal canceled",
    ]


def test_a_command_aborts_a_rotation(turtlesim: Running, outside: Outside) -> None:
    remaining: list[float] = []
    goal = rotate(outside, 3.0, remaining)
    outside.until(lambda: len(remaining) > 0, "feedback")
    outside.say("/turtle1/cmd_vel", turn(1.0, 0.0))
    assert ended(outside, goal).status == GoalStatus.STATUS_ABORTED


def test_two_worlds_live_in_namespaces_of_their_own(outside: Outside) -> None:
    with running("node", "--ros-args", "-r", "__ns:=/sim1"), running("node", "--ros-args", "-r", "__ns:=/sim2"):
        outside.call(TeleportAbsolute, "/sim1/turtle1/teleport_absolute", TeleportAbsolute.Request(x=1.0, y=1.0))
        deadline = time.monotonic() + DEADLINE_S
        while fetch(DEADLINE_S, node="/sim1/turtlesim").turtles[0].x != 1.0:
            assert time.monotonic() < deadline
        assert fetch(DEADLINE_S, node="/sim2/turtlesim").turtles[0].x == pytest.approx(CENTRE, abs=1e-4)


def test_a_parameter_out_of_range_at_the_start_is_reported_without_a_traceback(ros_domain: int) -> None:
    with running("node", "--ros-args", "-p", "background_r:=300") as node:
        assert node.process.wait(timeout=DEADLINE_S) == 1
        node.end(signal.SIGTERM)
    assert "background_r" in node.log[-1]
    assert not any("Traceback" in line for line in node.log)


def test_holonomic_turtles_move_sideways(outside: Outside) -> None:
    with running("node", "--ros-args", "-p", "holonomic:=true"):
        poses = outside.hear(Pose, "/turtle1/pose")
        twist = Twist()
        twist.linear.y = 1.0
        outside.until(lambda: len(poses) > 0, "a pose")
        outside.say("/turtle1/cmd_vel", twist)
        outside.until(lambda: poses[-1].y > CENTRE + 0.5, "a move to the left")
        assert poses[-1].x == pytest.approx(CENTRE, abs=1e-6)


def test_simulated_time_drives_the_turtle_tick_by_tick(outside: Outside) -> None:
    with running("node", "--ros-args", "-p", "use_sim_time:=true"):
        poses = outside.hear(Pose, "/turtle1/pose")
        outside.picture()
        now_ms = 1000
        clock = Clock()

        def move_on(milliseconds: int) -> None:
            nonlocal now_ms
            now_ms += milliseconds
            clock.clock.sec, clock.clock.nanosec = divmod(now_ms * 1_000_000, 1_000_000_000)
            outside.say("/clock", clock)

        def place() -> float:
            # One call may overtake the message, if the node is just checking what has arrived; a second does not.
            outside.picture()
            return float(outside.picture()["turtles"][0]["x"])

        while not poses:
            move_on(16)
            outside.picture()
        outside.say("/turtle1/cmd_vel", turn(1.0, 0.0))
        # The first command waits until the node knows its publisher: the turtle is seen to move, then stopped.
        while place() == pytest.approx(CENTRE, abs=1e-4):
            move_on(16)
        outside.say("/turtle1/cmd_vel", turn(0.0, 0.0))
        begin = place()
        outside.say("/turtle1/cmd_vel", turn(1.0, 0.0))
        assert place() == begin
        start = now_ms
        # A burst of ticks is longer than a queue: what the node itself says counts.
        while now_ms < start + 960:
            move_on(96)
            outside.until(
                lambda: outside.picture()["turtles"][0]["x"] >= round(begin + (now_ms - start) / 1000, 4) - 1e-4,
                f"the place at {now_ms} ms",
            )
        assert place() == pytest.approx(begin + 0.96, abs=2e-4)


def test_fetch_asks_the_running_node(turtlesim: Running, outside: Outside) -> None:
    world = fetch(timeout_s=DEADLINE_S)
    assert [turtle.name for turtle in world.turtles] == ["turtle1"]


def test_a_turtlesim_without_pictures_is_listened_to(outside: Outside, tmp_path: Path) -> None:
    publisher = outside.node.create_publisher(Pose, "/turtle1/pose", 10)
    arguments = ("--timeout", "0", "--listen", "1.5")
    deadline, code = time.monotonic() + DEADLINE_S, 1
    while code != 0:  # on a busy machine it may find the publisher only at a second try
        assert time.monotonic() < deadline
        with running("__main__", str(tmp_path / "heard.svg"), *arguments) as listener:
            published = 0
            while (status := listener.process.poll()) is None:
                publisher.publish(Pose(x=2.0 + published / 100, y=3.0, theta=0.0))
                published += 1
                time.sleep(0.02)
            code = status
    assert "only what was heard in" in (tmp_path / "heard.svg").read_text()


def test_without_any_turtlesim_the_reader_is_reported(ros_domain: int, tmp_path: Path) -> None:
    with running("__main__", str(tmp_path / "none.svg"), "--timeout", "0.1", "--listen", "0.2") as picture:
        assert picture.process.wait(timeout=DEADLINE_S) == 1
        picture.end(signal.SIGTERM)
    assert picture.log[0].startswith("No turtlesim is running: no /turtlesim, and nothing on /turtle1/pose")
    assert not any("Traceback" in line for line in picture.log)
    assert list(tmp_path.iterdir()) == []


def test_a_look_in_vain_leaves_no_node_behind(outside: Outside) -> None:
    kept: list[NoPictureError] = []  # a kept error keeps what its functions held

    def look() -> None:
        try:
            fetch(timeout_s=0.0, listen_s=1.0)
        except NoPictureError as error:
            kept.append(error)

    looking = threading.Thread(target=look)
    looking.start()
    outside.until(lambda: "turtle_picture" in outside.node.get_node_names(), "the node that looks")
    outside.until(lambda: bool(kept), "the end of the look")
    outside.until(lambda: "turtle_picture" not in outside.node.get_node_names(), "the node's end")
    looking.join()


def test_a_topic_of_another_type_is_reported(outside: Outside) -> None:
    outside.node.create_publisher(String, "/turtle1/pose", 10)
    deadline, message = time.monotonic() + DEADLINE_S, ""
    while "carries std_msgs/msg/String" not in message:  # a busy machine may need longer to find the publisher
        assert time.monotonic() < deadline, message
        with pytest.raises(NoPictureError) as caught:
            fetch(timeout_s=0.0, listen_s=1.0)
        message = str(caught.value)


def test_a_node_that_answers_with_something_else_is_reported(outside: Outside) -> None:
    def answer(_: Trigger.Request, response: Trigger.Response) -> Trigger.Response:
        response.message = "cheese"
        return response

    outside.node.create_service(Trigger, "/turtlesim/picture", answer)
    caught: list[Exception] = []

    def ask() -> None:
        try:
            fetch(timeout_s=DEADLINE_S)
        except NoPictureError as error:
            caught.append(error)

    asking = threading.Thread(target=ask)
    asking.start()
    outside.until(lambda: not asking.is_alive(), "the end of the question")
    assert "answered with something else" in str(caught[0])


def test_draw_square_drives_a_side_and_turns_a_corner(turtlesim: Running, outside: Outside) -> None:
    with running("draw_square") as square:
        outside.until(lambda: len(square.log) >= 3, "the third goal")
        assert square.log[0] == "[INFO] [draw_square]: New goal [7.544445 5.544445, 0.000000]"
        assert square.log[1] == "[INFO] [draw_square]: Reached goal"
        assert square.log[2].endswith("5.544445, 1.570796]")
        assert square.end(signal.SIGINT) == 0
