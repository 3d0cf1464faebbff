"""`%%interface` in a kernel: compiled when it is new, with a warning about what still has the former text."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from notebook_kernel import Kernel

MESSAGE = "%%interface msg/Limits.msg\nstring name\n"
NODE = (
    "%%node holder --until ready\nimport time\nfrom robot_interfaces.msg import Limits\n"
    'print(Limits(), "ready", flush=True)\ntime.sleep(60)\n'
)


def test_a_definition_is_compiled_once_a_changed_one_says_what_to_restart_and_another_notebook_finds_it(
    new_kernel: Callable[..., Kernel],
) -> None:
    kernel = new_kernel()

    first = kernel.run(MESSAGE)
    assert "robot_interfaces/msg/Limits: compiled in" in first.text, first.error
    assert "from robot_interfaces.msg import Limits" in first.text
    assert kernel.run(MESSAGE).text == "robot_interfaces/msg/Limits: ready.\n"
    assert "Limits(name='')" in kernel.run(NODE).text
    assert kernel.run("from robot_interfaces.msg import Limits; print(Limits())").error == ""

    changed = kernel.run(MESSAGE + "float64 upper\n")
    assert "Run the cells of these nodes again; they still use the old text: holder." in changed.text
    assert "This kernel has imported robot_interfaces already: restart it" in changed.text
    assert "Limits(name='', upper=0.0)" in kernel.run(NODE).text
    program = "%%node user --as robot_interfaces/user\nfrom robot_interfaces.msg import Limits\nprint(Limits())\n"
    assert "Limits(name='', upper=0.0)" in kernel.run(program).text, "its package has messages and programs"
    assert (
        kernel.folder / "robot_ws/src/robot_interfaces/msg/Limits.msg"
    ).read_text() == "string name\nfloat64 upper\n"
    assert (kernel.folder / "robot_ws/src/robot_interfaces/CMakeLists.txt").exists()

    second = new_kernel()
    second.run(f"import os; os.chdir({str(kernel.folder)!r})\n%chapter two --package robot --workspace robot_ws")
    found = second.run("from robot_interfaces.msg import Limits; print(Limits())").text
    assert found == "robot_interfaces.msg.Limits(name='', upper=0.0)\n"


@pytest.mark.parametrize(
    ("cell", "said"),
    [
        ("%%interface msg/Bad.msg\nfloat x\n", "msg/Bad.msg:1: `float` is not a type.\n    ROS 2 calls it float32."),
        ("%%interface Limits.msg\nfloat64 x\n", "`Limits.msg` is not an interface's name. Write msg/NAME.msg"),
        ("%%interface std_msgs/msg/String.msg\nstring data\n", "The package std_msgs is installed"),
    ],
)
def test_what_is_wrong_is_said_without_a_traceback(kernel: Kernel, cell: str, said: str) -> None:
    assert said in kernel.run(cell).error


def test_without_a_compiler_one_sentence_says_what_to_install(
    new_kernel: Callable[..., Kernel], tmp_path: Path
) -> None:
    empty = tmp_path / "bin"
    empty.mkdir()

    shown = new_kernel(PATH=str(empty)).run(MESSAGE)

    assert shown.error.startswith("Interfaces are compiled with gcc and g++, not found here:")
