"""`ros2 pkg create` writes packages of C++ and of Python; `ros2 multicast` says what it can't do."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from pathlib import Path

from ros2_terminal import Terminal


def test_a_package_of_cpp_has_what_cmake_needs(terminal: Terminal, tmp_path: Path) -> None:
    words = ("mycmake", "--dependencies", "rclcpp", "std_msgs", "--node-name", "talker", "--library-name", "voice")
    made = terminal.ros2("pkg", "create", *words, "--license", "Apache-2.0", cwd=tmp_path)
    assert (made.code, made.err) == (0, "")
    folder = tmp_path / "mycmake"
    files = sorted(str(file.relative_to(folder)) for file in folder.rglob("*") if file.is_file())
    assert files == ["CMakeLists.txt", "include/mycmake/voice.hpp", "package.xml", "src/talker.cpp", "src/voice.cpp"]
    text = (folder / "CMakeLists.txt").read_text()
    for part in ("project(mycmake)", "find_package(rclcpp REQUIRED)", "add_executable(talker", "ament_package()"):
        assert part in text
    package = ElementTree.parse(folder / "package.xml").getroot()
    assert [item.text for item in package.findall("depend")] == ["rclcpp", "std_msgs"]
    assert package.findtext("buildtool_depend") == package.findtext("export/build_type") == "ament_cmake"


def test_cmake_is_the_default_and_what_can_not_be_made_is_refused(terminal: Terminal, tmp_path: Path) -> None:
    assert terminal.ros2("pkg", "create", "plain", cwd=tmp_path).code == 0
    assert "find_package(ament_cmake REQUIRED)" in (tmp_path / "plain" / "CMakeLists.txt").read_text()
    for words, text in (
        (("--build-type", "cmake", "x"), "no build type 'cmake'"),
        (("--build-type", "ament_python", "--library-name", "l", "x"), "has no library"),
        (("my", "package"), "'package' is left over: the name is 'my'."),
        (("x", "--nod"), "There is no option '--nod'."),
        (("--dependencies", "rclpy", "x"), "Write it before --dependencies"),
    ):
        refused = terminal.ros2("pkg", "create", *words, cwd=tmp_path)
        assert refused.code == 1
        assert text in refused.err


def test_the_share_folder_of_a_package(terminal: Terminal) -> None:
    whole = terminal.ros2("pkg", "prefix", "std_msgs").out.strip()
    assert terminal.ros2("pkg", "prefix", "--share", "std_msgs").out.strip() == f"{whole}/share/std_msgs"
    assert Path(whole, "share", "std_msgs").is_dir()


def test_a_datagram_that_does_not_come_is_a_sentence(terminal: Terminal) -> None:
    said = terminal.ros2("multicast", "receive", "--timeout", "0.1", "--port", "49751")
    assert said.code == 1
    assert said.out == "Waiting for UDP multicast datagram...\n"
    assert "Traceback" not in said.err
