"""A node's cell without its `%%node` line spins in the notebook itself: that is said, and Stop ends it."""

from __future__ import annotations

import pytest
from notebook_kernel import Kernel
from test_nodes import TALKER

QUIET = """import rclpy
from rclpy.node import Node

rclpy.init()
rclpy.spin(Node("quiet"))
"""


@pytest.mark.parametrize("code", [TALKER, QUIET], ids=["that catches Ctrl-C", "without a timer"])
def test_stop_ends_a_cell_that_spins_and_the_notebook_goes_on(kernel: Kernel, code: str) -> None:
    kernel.run(f"%%node talker --seconds 0\n{TALKER}")
    kernel.run("%stop --all")
    for _ in range(2):
        shown = kernel.run(code, kernel.pressing_stop(lambda shown: "press Stop" in shown.text))
        assert "no other cell can run until you press Stop" in shown.text
        kernel.run("rclpy.try_shutdown()")
    name = "talker" if code == TALKER else "my_node"
    assert f"make `%%node {name}` its first line" in shown.text
    assert "KeyboardInterrupt" in shown.error if code == QUIET else "bye" in shown.text
    assert kernel.run("1 + 1").error == ""


def test_a_snippet_that_waits_for_an_answer_can_be_stopped(kernel: Kernel) -> None:
    waits = "import rclpy\nrclpy.init()\nnode = rclpy.create_node('asks')\nprint('waits', flush=True)\n"
    waits += "rclpy.spin_until_future_complete(node, rclpy.Future())"
    shown = kernel.run(waits, kernel.pressing_stop(lambda shown: "waits" in shown.text))
    assert "KeyboardInterrupt" in shown.error
    assert "executors.py" not in shown.error, "only the reader's own frames"
    kernel.run("rclpy.try_shutdown()")
