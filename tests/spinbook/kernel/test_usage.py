"""Wrong usage of the notebook's commands is explained, and each command has help."""

from __future__ import annotations

import pytest
from notebook_kernel import Kernel


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("%%node 1bad\nx = 1", "can't be a node's file name"),
        ("%%node\nx = 1", "required: name"),
        ("%%node a --seconds soon\nx = 1", "invalid float value"),
        ("%log nobody", "Started: none"),
        ("%log nobody  # it's quiet", "Started: none"),
        ("%log nobody#2", "nobody#2"),
        ("%ros2 topic pub 'x", "quotation mark"),
        ("%colcon build", "run the chapter's node cells first"),
        ("%ros2 run turtlesim", "ros2 run PACKAGE EXECUTABLE"),
        ("%domain 500", "a number from 0 to 101"),
        ("%turtle", "turtlesim"),
        ("%robot no_such_robot", "no installed package 'no_such_robot'"),
    ],
)
def test_bad_usage_is_reported_in_words(module_kernel: Kernel, line: str, words: str) -> None:
    error = module_kernel.run(line).error

    assert words in error
    assert "Traceback" not in error


@pytest.mark.parametrize("command", ["node", "nodes", "stop", "log", "plot", "turtle", "robot", "domain"])
def test_every_command_explains_itself(module_kernel: Kernel, command: str) -> None:
    line = "%%node --help\nx" if command == "node" else f"%{command} --help"

    assert module_kernel.run(line).text.startswith("usage: ")
