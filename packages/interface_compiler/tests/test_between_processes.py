"""Compiled types between two processes, over real rclpy and Fast DDS."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from definitions import definition

from interface_compiler import prefixes
from interface_compiler.activation import extend
from interface_compiler.store import CompiledPackages, ensure

HERE = Path(__file__).parent
Asked = list[tuple[str, dict[str, Any]]]


def environment(compiled: CompiledPackages | None) -> dict[str, str]:
    variables = dict(os.environ)
    if compiled is not None:
        extend(variables, compiled.prefix)
    return variables


def talk(tmp_path: Path, asked: Asked, ours: CompiledPackages | None, theirs: CompiledPackages | None) -> str:
    """Let one process ask the other one; return what the asking one prints."""
    file = tmp_path / "asked.json"
    file.write_text(json.dumps(asked))
    names = [name for name, _ in asked]
    peer = subprocess.Popen([sys.executable, str(HERE / "peer.py"), *names], env=environment(theirs))
    try:
        command = [sys.executable, str(HERE / "asker.py"), str(file)]
        done = subprocess.run(command, env=environment(ours), capture_output=True, text=True, timeout=240, check=False)
        return done.stdout + done.stderr
    finally:
        peer.send_signal(signal.SIGINT)
        peer.wait(60)


LIMITS = {
    "name": "hip",
    "kind": 1,
    "axis": [0.5, -0.25, 0.0],
    "samples": [1.0, 2.0],
    "label": "Hüfte 腰",
    "poses": [{"position": {"x": 1.5}}, {"orientation": {"w": 0.5}}],
    "header": {"frame_id": "base", "stamp": {"sec": 7}},
}


@pytest.mark.usefixtures("ros_domain")
def test_nested_bounded_default_and_wide_fields_and_a_service(
    tmp_path: Path, robot_interfaces: CompiledPackages
) -> None:
    asked: Asked = [
        ("robot_interfaces/msg/JointLimits", LIMITS),
        ("robot_interfaces/srv/GetLimits", {"names": ["hip", "knee"]}),
    ]

    assert talk(tmp_path, asked, robot_interfaces, robot_interfaces) == "all as expected\n"


@pytest.mark.usefixtures("ros_domain")
def test_add_two_ints_and_fibonacci_with_feedback_and_cancel(tmp_path: Path) -> None:
    asked: Asked = [
        ("example_interfaces/srv/AddTwoInts", {"a": 2, "b": -40}),
        ("example_interfaces/action/Fibonacci", {"order": 5}),
        ("example_interfaces/action/Fibonacci", {"order": 1000}),
    ]

    assert talk(tmp_path, asked, None, None) == "all as expected\n"


@pytest.mark.soak
@pytest.mark.usefixtures("ros_domain")
@pytest.mark.parametrize("asking", ["ours", "theirs"])
def test_a_package_compiled_here_talks_to_the_same_one_made_by_cmake(
    tmp_path: Path, rebuilt_test_msgs: CompiledPackages, asking: str
) -> None:
    asked: Asked = [
        ("test_msgs/msg/Nested", {"basic_types_value": {"int8_value": -3, "float64_value": 0.125, "bool_value": True}}),
        ("test_msgs/msg/WStrings", {"wstring_value": "Hüfte 腰"}),
        ("test_msgs/msg/Defaults", {"uint16_value": 77}),
        ("test_msgs/msg/BoundedPlainSequences", {"int32_values": [1, -2], "basic_types_values": [{"char_value": 5}]}),
        ("test_msgs/srv/BasicTypes", {"int64_value": 2**40, "string_value": "hip"}),
        ("test_msgs/action/Fibonacci", {"order": 5}),
        ("test_msgs/action/Fibonacci", {"order": 1000}),
    ]
    pair = (rebuilt_test_msgs, None) if asking == "ours" else (None, rebuilt_test_msgs)

    assert talk(tmp_path, asked, *pair) == "all as expected\n"


@pytest.fixture(scope="session")
def rebuilt_test_msgs(tmp_path_factory: pytest.TempPathFactory) -> CompiledPackages:
    """A part of test_msgs, from the definitions in its wheel, which CMake made."""
    wanted = [
        *("msg/BasicTypes.msg", "msg/Nested.msg", "msg/WStrings.msg", "msg/Defaults.msg", "msg/Constants.msg"),
        *("msg/BoundedPlainSequences.msg", "srv/BasicTypes.srv", "action/Fibonacci.action"),
    ]
    texts = prefixes.definitions_of("test_msgs", Path(sys.prefix))
    return ensure([definition(path, texts[path], "test_msgs") for path in wanted], tmp_path_factory.mktemp("store"))
