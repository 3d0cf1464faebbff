"""Definitions become packages once, and again only when something changes."""

from __future__ import annotations

import io
import json
import os
import re
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from definitions import definition, robot

from interface_compiler import prefixes, shipped, store, toolchain
from interface_compiler.activation import extend
from interface_compiler.definition import CompileError, DefinitionError
from interface_compiler.store import CompiledPackages, ensure, find
from interface_compiler.wheel import wheel

POINT = definition("msg/Point.msg", "float64 x 1.5\n", "small_interfaces")


@pytest.fixture(scope="module")
def point(tmp_path_factory: pytest.TempPathFactory) -> CompiledPackages:
    """The compiled point, in a store of its own."""
    return ensure([POINT], tmp_path_factory.mktemp("store"))


USE = """
from robot_interfaces.msg import JointLimits
from robot_interfaces.srv import GetLimits
from robot_interfaces.action import MoveJoint
limits = JointLimits()
assert (limits.REVOLUTE, limits.kind, limits.lower, list(limits.axis)) == (0, 1, -1.57, [0.0, 0.0, 1.0]), limits
assert limits.label == "Gelenk ä" and GetLimits.Response(limits=[limits]).limits[0].kind == 1
MoveJoint.Result(limits=limits)
limits.samples = [0.0] * 8
try:
    limits.samples = [0.0] * 9
except AssertionError:
    print("fine")
"""


def run(code: str, compiled: CompiledPackages) -> str:
    # rclpy's messages check the given values only when asked to.
    environment = {**os.environ, "ROS_PYTHON_CHECK_FIELDS": "1"}
    extend(environment, compiled.prefix)
    done = subprocess.run(
        [sys.executable, "-c", code], env=environment, capture_output=True, text=True, timeout=60, check=False
    )
    return done.stdout + done.stderr


def test_constants_defaults_and_bounds_are_those_of_the_definition(robot_interfaces: CompiledPackages) -> None:
    assert run(USE, robot_interfaces) == "fine\n"


def test_the_package_is_known_to_ament_with_its_definitions(robot_interfaces: CompiledPackages) -> None:
    prefix = robot_interfaces.prefix

    assert prefixes.interfaces([prefix])["robot_interfaces"] >= {"msg/JointLimits", "srv/GetLimits", "action/MoveJoint"}
    assert prefixes.interfaces_of("robot_interfaces", [prefix]) == prefixes.interfaces([prefix])["robot_interfaces"]
    assert not prefixes.interfaces_of("other_interfaces", [prefix])
    assert prefixes.definitions_of("robot_interfaces", prefix) == {item.path: item.text for item in robot()}


def test_nothing_changed_nothing_is_compiled(point: CompiledPackages, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", "")  # so that no compiler can be found

    again = ensure([POINT], point.prefix.parent)

    assert point.fresh
    assert not again.fresh
    assert again.prefix == point.prefix
    assert find([POINT], point.prefix.parent) == again


def test_another_text_is_another_package_and_the_former_one_stays(point: CompiledPackages) -> None:
    second = ensure([definition("msg/Point.msg", "float64 y\n", "small_interfaces")], point.prefix.parent)

    assert "y=0.0" in run("from small_interfaces.msg import Point; print(Point())", second)
    assert "x=1.5" in run("from small_interfaces.msg import Point; print(Point())", point)


def test_a_package_may_use_another_ones_messages(tmp_path: Path) -> None:
    other = definition("msg/Path.msg", "small_interfaces/Point[] points\nturtlesim/Pose pose\n", "more_interfaces")

    compiled = ensure([other, POINT], tmp_path)

    code = (
        "from rclpy.serialization import deserialize_message, serialize_message\n"
        "from more_interfaces.msg import Path\nfrom small_interfaces.msg import Point\n"
        "path = Path(points=[Point(x=2.0)])\npath.pose.theta = 0.5\n"
        "print(deserialize_message(serialize_message(path), Path) == path)"
    )
    assert run(code, compiled) == "True\n"


def test_the_same_definitions_give_the_same_wheel_wherever_it_is_made(point: CompiledPackages, tmp_path: Path) -> None:
    again = ensure([POINT], tmp_path)

    assert again.fresh
    assert wheel("small_interfaces", again.prefix) == wheel("small_interfaces", point.prefix)


def test_one_wheel_fits_every_python_from_3_10_on(robot_interfaces: CompiledPackages) -> None:
    name, content = wheel("robot_interfaces", robot_interfaces.prefix)
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        (module,) = (file for file in archive.namelist() if file.endswith(".so"))
        code = archive.read(module)

    assert "-cp310-abi3-manylinux_2_28_" in name
    assert module.endswith("_s__rosidl_typesupport_c.abi3.so")
    # Only the limited API's: functions of later versions, and what looks into Python's objects, are not called.
    called = {symbol.decode() for symbol in re.findall(rb"\0(_?Py[A-Za-z]\w+)(?=\0)", code)}
    assert {"PyBytes_FromObject", "PyMemoryView_FromObject", "PyList_GetItem"} <= called
    assert not called & {"PyObject_GetBuffer", "PyObject_CheckBuffer", "PyBuffer_Release", "PyBuffer_ToContiguous"}


def test_two_who_want_the_same_wait_for_one_another(tmp_path: Path) -> None:
    code = (
        "import sys; from pathlib import Path; from interface_compiler.definition import Definition\n"
        "from interface_compiler.store import ensure\n"
        "item = Definition('small_interfaces', 'msg', 'Point', 'float64 x\\n', Path('Point.msg'))\n"
        "print(ensure([item], Path(sys.argv[1])).fresh)"
    )
    command = [sys.executable, "-c", code, str(tmp_path)]
    both = [subprocess.Popen(command, stdout=subprocess.PIPE, text=True) for _ in range(2)]

    assert sorted(process.communicate(timeout=120)[0] for process in both) == ["False\n", "True\n"]


def test_wrong_definitions_are_reported_and_nothing_is_kept(tmp_path: Path) -> None:
    with pytest.raises(DefinitionError) as caught:
        ensure([definition("msg/Point.msg", "float x\n")], tmp_path)

    assert "interfaces/robot_interfaces/msg/Point.msg:1: `float` is not a type." in str(caught.value)
    assert list(tmp_path.iterdir()) == []


def test_without_a_compiler_one_sentence_names_the_package_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "apt-get").touch(mode=0o755)
    monkeypatch.setenv("PATH", str(tmp_path / "bin"))

    with pytest.raises(CompileError) as caught:
        ensure([POINT], tmp_path / "store")

    assert str(caught.value).splitlines() == [
        "Interfaces are compiled with gcc and g++, not found here: sudo apt-get install g++"
    ]


def test_without_python_h_one_sentence_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(toolchain, "headers", lambda: tmp_path)

    with pytest.raises(CompileError, match=r"^Interfaces are compiled with Python\.h, .*install.*$"):
        ensure([POINT], tmp_path / "store")


def test_a_compiler_that_fails_is_reported_in_its_own_words(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "bin").mkdir()
    for name in ("gcc", "g++"):
        file = tmp_path / "bin" / name
        file.write_text("#!/bin/sh\necho 'error: no space left' >&2\nexit 1\n")
        file.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path / 'bin'}:{os.environ['PATH']}")

    with pytest.raises(CompileError, match=r"failed on the package small_interfaces: .*no space left"):
        ensure([POINT], tmp_path / "store")

    assert find([POINT], tmp_path / "store") is None


def test_old_prefixes_do_not_pile_up(point: CompiledPackages, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(store, "_KEPT", 1)
    first = shutil.copytree(point.prefix, tmp_path / point.key)

    second = ensure([definition("msg/Point.msg", "float64 y\n", "small_interfaces")], tmp_path)

    assert not first.exists()
    assert second.prefix.exists()


#: Nobody has published the hashes of these.
UNPUBLISHED = {"tf2_msgs/action/LookupTransform", "tf2_msgs/srv/FrameGraph"}

#: Of ROS 2 packages that CMake built elsewhere, from the code and the descriptions that its generators wrote there; of
#: tf2_msgs, as the package rosbags works them out of its own copies of the messages.
PUBLISHED = json.loads(Path(__file__).with_name("published_hashes.json").read_text(encoding="utf-8"))


@pytest.mark.parametrize("package", shipped.standard())
def test_type_hashes_are_the_published_ones(package: str) -> None:
    share = Path(sys.prefix, "share", package)
    described = [json.loads(file.read_text(encoding="utf-8")) for file in share.glob("*/*.json")]
    hashes = {entry["type_name"]: entry["hash_string"] for one in described for entry in one["type_hashes"]}

    names = {item.full_name for item in shipped.definitions(package)} - UNPUBLISHED
    ours = {name: hashes[name] for name in names}

    assert ours == {name: published for name, published in PUBLISHED.items() if name.startswith(f"{package}/")}
