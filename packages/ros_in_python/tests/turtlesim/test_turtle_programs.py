"""Programs that drive the turtle: turtlesim's own mimic and teleop, and ones as students write them."""

from __future__ import annotations

import os
import pty
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
from geometry_msgs.msg import Twist
from test_turtle_node import DEADLINE_S, Outside, Running, running, turn
from test_turtle_node import outside as outside
from test_turtle_node import turtlesim as turtlesim
from turtlesim.msg import Pose

GO_TO_GOAL = '''
import math, sys
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node
from turtlesim.msg import Pose
from turtlesim.srv import Spawn


class GoToGoal(Node):
    """Spawns a turtle and drives it to a place, by its pose."""

    def __init__(self):
        super().__init__("go_to_goal")
        client = self.create_client(Spawn, "spawn")
        while not client.wait_for_service(timeout_sec=1.0):
            self.get_logger().info("waiting for turtlesim")
        answer = client.call_async(Spawn.Request(x=2.0, y=2.0, theta=0.0, name="walker"))
        rclpy.spin_until_future_complete(self, answer)
        self.name = answer.result().name
        self.publisher = self.create_publisher(Twist, f"{self.name}/cmd_vel", 10)
        self.create_subscription(Pose, f"{self.name}/pose", self.drive, 10)

    def drive(self, pose):
        dx, dy = 8.0 - pose.x, 4.0 - pose.y
        twist = Twist()
        if math.hypot(dx, dy) < 0.1:
            self.publisher.publish(twist)
            print("arrived", self.name, flush=True)
            raise SystemExit
        error = math.atan2(dy, dx) - pose.theta
        twist.linear.x = 3.0 * math.hypot(dx, dy)
        twist.angular.z = 6.0 * math.atan2(math.sin(error), math.cos(error))
        self.publisher.publish(twist)


rclpy.init()
rclpy.spin(GoToGoal())
'''


def test_a_students_program_spawns_a_turtle_and_drives_it_to_a_place(turtlesim: Running, outside: Outside) -> None:
    done = subprocess.run([sys.executable, "-c", GO_TO_GOAL], capture_output=True, text=True, timeout=DEADLINE_S)
    assert done.stdout == "arrived walker\n", done.stderr
    walker = next(turtle for turtle in outside.picture()["turtles"] if turtle["name"] == "walker")
    assert (walker["x"], walker["y"]) == pytest.approx((8.0, 4.0), abs=0.3)


def test_mimic_moves_one_turtle_as_another(outside: Outside) -> None:
    twists = outside.hear(Twist, "/turtle2/cmd_vel")
    remaps = ("-r", "input/pose:=turtle1/pose", "-r", "output/cmd_vel:=turtle2/cmd_vel")
    with running("mimic", "--ros-args", *remaps) as mimic:
        outside.say("/turtle1/pose", Pose(linear_velocity=2.0, angular_velocity=-1.5))
        outside.until(lambda: len(twists) > 0, "a command")
        assert mimic.end(signal.SIGINT) == 0
    assert twists[0] == turn(2.0, -1.5)


class Keyboard:
    """A terminal with turtle_teleop_key in it."""

    def __init__(self) -> None:
        self._master, inner = pty.openpty()
        command = [sys.executable, "-m", "ros_in_python.turtlesim.teleop_key"]
        self.process = subprocess.Popen(command, stdin=inner, stdout=inner, stderr=inner)
        os.close(inner)
        self.shown = b""
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self) -> None:
        try:
            while data := os.read(self._master, 4096):
                self.shown += data
        except OSError:
            pass

    def press(self, keys: bytes) -> None:
        os.write(self._master, keys)


@pytest.fixture
def keyboard(outside: Outside) -> Iterator[Keyboard]:
    """Teleop, once it has printed its usage."""
    keyboard = Keyboard()
    outside.until(lambda: b"'q' to quit." in keyboard.shown, "the help")
    yield keyboard
    keyboard.process.kill()
    keyboard.process.wait()


@pytest.mark.parametrize(
    ("key", "forward", "turning"),
    [(b"\x1b[A", 2.0, 0.0), (b"\x1b[B", -2.0, 0.0), (b"\x1b[C", 0.0, -2.0), (b"\x1bOD", 0.0, 2.0)],
)
def test_an_arrow_key_is_one_command(
    keyboard: Keyboard, outside: Outside, key: bytes, forward: float, turning: float
) -> None:
    twists = outside.hear(Twist, "/turtle1/cmd_vel")
    outside.until(lambda: outside.node.count_publishers("/turtle1/cmd_vel") > 0, "the publisher")
    while not twists:
        keyboard.press(key)
        outside.moment()
    assert twists[0] == turn(forward, turning)


def test_keys_around_f_turn_to_a_heading_and_f_stops(turtlesim: Running, keyboard: Keyboard, outside: Outside) -> None:
    poses = outside.hear(Pose, "/turtle1/pose")
    outside.until(lambda: len(poses) > 0, "a pose")
    # As with the real one, a key is lost as long as the two nodes do not know one another.
    while poses[-1].theta < 0.1:
        keyboard.press(b"t")
        outside.moment()
    outside.until(lambda: poses[-1].theta == pytest.approx(0.7854, abs=0.03), "the heading")
    outside.until(lambda: turtlesim.log[-1].endswith("Rotation goal completed successfully"), "the rotation's end")
    keyboard.press(b"c")
    outside.until(lambda: poses[-1].theta < 0.5, "the second rotation")
    keyboard.press(b"f")
    outside.until(lambda: turtlesim.log[-1].endswith("Rotation goal canceled"), "its end")
    before = len(turtlesim.log)
    keyboard.press(b"ef")  # F is pressed before turtlesim has accepted the rotation
    outside.until(lambda: len(turtlesim.log) > before, "the end of the third rotation")
    assert turtlesim.log[-1].endswith("Rotation goal canceled")


@pytest.mark.parametrize("how", ["Q", "Ctrl-C"])
def test_q_and_ctrl_c_end_teleop_in_order(keyboard: Keyboard, how: str) -> None:
    if how == "Q":
        keyboard.press(b"q")
    else:
        keyboard.process.send_signal(signal.SIGINT)
    assert keyboard.process.wait(timeout=DEADLINE_S) == 0
    assert b"Traceback" not in keyboard.shown


def test_without_a_terminal_teleop_says_so(ros_domain: int, tmp_path: Path) -> None:
    command = [sys.executable, "-m", "ros_in_python.turtlesim.teleop_key"]
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=DEADLINE_S)
    assert (done.returncode, done.stderr) == (
        1,
        "turtle_teleop_key reads keys from a terminal: run it in one.\n",
    )
