"""Set-up uses a sourced ROS 2 if it fits, the wheels if there is none, and never both."""

from __future__ import annotations

from pathlib import Path

import pytest
from setup_stage import Checkout
from sourced_ros import empty_rclpy, ros_1

from spinbook.doctor.ros_origin import Machine, NoRos, ros_origin

DEBIAN = Machine("Linux", "x86_64", "glibc 2.36", (3, 11), [".cpython-311-x86_64-linux-gnu.so", ".abi3.so", ".so"])


def installed(checkout: Checkout) -> str:
    """Return the pins that were installed."""
    return "".join(file.read_text() for file in (checkout.folder / ".venv").glob("pins-*.txt"))


def test_without_a_sourced_ros_the_wheels_are_installed(checkout: Checkout) -> None:
    checkout.set_up()
    assert "ros-rclpy==7" in installed(checkout)


def test_with_a_sourced_ros_its_wheels_are_left_out(checkout: Checkout, tmp_path: Path) -> None:
    code, said = checkout.set_up(**empty_rclpy(tmp_path / "jazzy"))
    assert code == 0
    assert "click==8" in installed(checkout)
    assert "ros-rclpy" not in installed(checkout)
    assert f"ROS 2 is the sourced one in {tmp_path}/jazzy" in said


def test_pip_does_not_see_the_sourced_ros(checkout: Checkout, tmp_path: Path) -> None:
    checkout.set_up(**empty_rclpy(tmp_path / "jazzy"))
    assert all("PYTHONPATH=unset" in call for call in checkout.calls if call.startswith("pip"))


def test_an_environment_with_wheels_is_made_anew_once_ros_is_sourced_and_back(
    checkout: Checkout, tmp_path: Path
) -> None:
    checkout.set_up()
    for settings, wheels in ((empty_rclpy(tmp_path / "jazzy"), False), ({}, True)):
        checkout.forget_calls()
        code, said = checkout.set_up(**settings)
        assert code == 0
        assert "was made for something else" in said
        assert checkout.calls[0] == "venv .venv"
        assert ("ros-rclpy" in installed(checkout)) is wheels
        assert checkout.set_up(**settings) == (0, "")


def test_a_sourced_ros_that_does_not_load_is_reported(checkout: Checkout, tmp_path: Path) -> None:
    checkout.tell(
        "ros-fails", "Traceback (most recent call last):\nImportError: librcl.so: cannot open shared object file"
    )
    code, said = checkout.set_up(**empty_rclpy(tmp_path / "jazzy"))
    assert code == 1
    assert "Was its setup file sourced in this terminal?" in said
    assert "librcl.so" in said
    assert "Traceback" not in said


@pytest.mark.parametrize(
    ("sourced", "message"),
    [
        (lambda prefix: empty_rclpy(prefix, ".cpython-38-x86_64-linux-gnu.so"), "make PYTHON=python3.12"),
        (lambda prefix: empty_rclpy(prefix, distro="humble"), "The sourced ROS 2 is Humble"),
        (ros_1, "ROS 1?"),
    ],
    ids=["for another Python", "older than Jazzy", "ROS 1"],
)
def test_a_sourced_ros_that_can_not_be_used_is_refused_and_nothing_is_made(
    checkout: Checkout, tmp_path: Path, sourced: object, message: str
) -> None:
    assert callable(sourced)
    code, said = checkout.set_up(**sourced(tmp_path / "ros"))
    assert code == 1
    assert message in said
    assert "no ROS setup file is sourced" in said
    assert checkout.calls == []


def test_the_first_rclpy_on_the_path_counts(tmp_path: Path) -> None:
    suffix = DEBIAN.suffixes[0]
    first, second = (empty_rclpy(tmp_path / name, suffix)["PYTHONPATH"] for name in ("overlay", "jazzy"))
    origin = ros_origin({"PYTHONPATH": f"/nowhere:{first}:{second}"}, DEBIAN)
    assert origin.sourced == Path(first)


@pytest.mark.parametrize(
    ("system", "processor", "libc", "reason"),
    [
        ("Linux", "aarch64", "glibc 2.36", "this is Linux on aarch64"),
        ("Darwin", "arm64", "", "this is Darwin on arm64"),
        ("Linux", "x86_64", "glibc 2.27", "this Linux has glibc 2.27"),
        ("Linux", "x86_64", "", "this Linux has another C library"),
    ],
)
def test_where_no_wheels_fit_another_way_is_named(system: str, processor: str, libc: str, reason: str) -> None:
    machine = Machine(system, processor, libc, (3, 12), [".cpython-312-x86_64-linux-gnu.so"])
    with pytest.raises(NoRos, match=reason) as caught:
        ros_origin({}, machine)
    assert "container" in str(caught.value)


def test_where_no_wheels_fit_a_sourced_ros_is_used_all_the_same(tmp_path: Path) -> None:
    machine = Machine("Linux", "aarch64", "glibc 2.39", (3, 12), [".cpython-312-aarch64-linux-gnu.so"])
    sourced = empty_rclpy(tmp_path, machine.suffixes[0])
    assert ros_origin(sourced, machine).sourced == Path(sourced["PYTHONPATH"])
