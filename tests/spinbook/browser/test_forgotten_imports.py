"""A program that forgets an import fails in a page as in a new Python, whatever was imported there before it."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
PAGE_PROGRAMS = Path(__file__).with_name("page_programs.py")

#: Shows after each step which modules of ROS there are, and what they have as attributes; forgets its last import.
FORGETFUL = """
import re, sys
def show():
    for name in sorted(sys.modules):
        if re.match(r"rclpy(?!._rclpy_pybind11)|\\w+\\.(msg|srv|action)$", name):
            print(name, sorted(key for key, value in vars(sys.modules[name]).items() if type(value) is type(sys)))
    print()
show()
import rclpy
show()
from rclpy.node import Node
show()
import sensor_msgs.msg
from rclpy.action import ActionClient
show()
rclpy.init()
node = Node("n")
node.create_subscription(sensor_msgs.msg.JointState, "/joint_states", print, 10)
show()
import rclpy.lifecycle
show()
print(rclpy.__spec__.name, rclpy.lifecycle.__spec__.origin, type(rclpy.lifecycle.__loader__))
rclpy.shutdown()
import std_srvs
print(std_srvs.srv)
"""


#: The page imports modules while this program waits.
WAITING = """
import sensor_msgs, nav_msgs, std_msgs.msg
def page_goes_on():
    for name in ("sensor_msgs.msg", "nav_msgs.msg", "std_msgs.msg"):
        page_imports(name)
    print([hasattr(package, "msg") for package in (sensor_msgs, nav_msgs, std_msgs)])
page_goes_on()
import nav_msgs.msg
page_goes_on()
"""

HAS = "print([hasattr(rclpy, 'action'), hasattr(rclpy, 'qos'), hasattr(geometry_msgs, 'msg')])\n"
CELLS = (
    f"import rclpy, geometry_msgs\n{HAS}",
    f"from rclpy import qos\nimport geometry_msgs.msg\n{HAS}",
    f"{HAS}rclpy.action",
)


@pytest.fixture(scope="module")
def printed() -> list[str]:
    """What the cells and programs print, one after another in one interpreter."""
    given = [("cell", code) for code in CELLS] + [("program", code) for code in (FORGETFUL, WAITING, FORGETFUL)]
    command = [sys.executable, os.fspath(PAGE_PROGRAMS)]
    done = subprocess.run(command, input=json.dumps(given), capture_output=True, text=True, cwd=ROOT, check=False)
    assert done.returncode == 0, done.stderr
    found: list[str] = json.loads(done.stdout)
    return found


def test_each_program_of_a_process_sees_what_it_sees_in_a_new_python(printed: list[str]) -> None:
    new = subprocess.run([sys.executable, "-c", FORGETFUL], capture_output=True, text=True, check=False)
    error = "AttributeError: module 'std_srvs' has no attribute 'srv'"
    assert new.stderr.splitlines()[-1] == error

    first, _, again = printed[3:]

    assert first.startswith(new.stdout)
    assert first.splitlines()[-1] == error
    assert again == first


def test_what_the_page_imports_while_a_program_waits_is_hidden_from_it(printed: list[str]) -> None:
    assert printed[4] == "[False, False, True]\n[False, True, True]\n"


def test_plain_cells_see_what_cells_before_them_have_imported(printed: list[str]) -> None:
    assert printed[:2] == ["[False, False, False]\n", "[False, True, True]\n"]
    assert printed[2].startswith("[False, True, True]\n")
    assert printed[2].splitlines()[-1] == "AttributeError: module 'rclpy' has no attribute 'action'"
