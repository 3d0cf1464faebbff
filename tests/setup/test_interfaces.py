"""Set-up compiles what PyPI lacks, such as turtlesim; without a compiler it continues without."""

from __future__ import annotations

from pathlib import Path

from setup_stage import INTERFACES, Checkout
from sourced_ros import empty_rclpy

NO_COMPILER = "Interfaces are compiled with g++, not found here: sudo apt-get install g++"


def compiled(checkout: Checkout) -> int:
    return checkout.calls.count("interfaces ")


def test_interfaces_are_compiled_last(checkout: Checkout) -> None:
    checkout.set_up()

    assert checkout.calls[-1] == "interfaces "


def test_changed_definitions_are_compiled_and_nothing_else_is_done(checkout: Checkout) -> None:
    checkout.set_up()
    checkout.forget_calls()
    (checkout.folder / INTERFACES / "Pose.msg").write_text("float64 x\n")

    assert checkout.set_up()[0] == 0
    assert checkout.calls == ["interfaces "]
    assert checkout.set_up() == (0, "")


def test_what_python_caches_beside_them_does_not_count(checkout: Checkout) -> None:
    checkout.set_up()
    (checkout.folder / INTERFACES / "__pycache__").mkdir()
    (checkout.folder / INTERFACES / "__pycache__" / "checks.pyc").touch()

    assert checkout.set_up() == (0, "")


def test_without_a_compiler_set_up_says_what_to_install_and_all_else_works(checkout: Checkout) -> None:
    checkout.tell("no-compiler", NO_COMPILER)
    checkout.tell("compiler-is", "")

    code, said = checkout.set_up()

    assert code == 0
    assert NO_COMPILER in said.splitlines()


def test_where_there_was_no_compiler_the_next_run_tries_again(checkout: Checkout) -> None:
    checkout.tell("no-compiler", NO_COMPILER)
    checkout.tell("compiler-is", "")
    checkout.set_up()
    (checkout.stage / "no-compiler").unlink()
    checkout.forget_calls()

    assert checkout.set_up()[0] == 0
    assert checkout.calls == ["interfaces "]
    assert checkout.set_up() == (0, "")


def test_a_missing_compiler_is_installed_where_that_is_possible(checkout: Checkout) -> None:
    checkout.tell("no-compiler", NO_COMPILER)
    checkout.tell("compiler-is", "g++")
    install = '#!/bin/sh\necho "apt-get $*" >>"$STAGE/calls"\n[ "$1" != install ] || rm -f "$STAGE/no-compiler"\n'
    checkout.program("apt-get", install)
    checkout.program("sudo", '#!/bin/sh\nshift\nexec "$@"\n')

    code, said = checkout.set_up()

    assert code == 0
    assert NO_COMPILER not in said
    assert "apt-get install -y -qq --no-install-recommends g++" in checkout.calls


def test_a_sourced_ros_compiles_its_own(checkout: Checkout, tmp_path: Path) -> None:
    checkout.set_up(**empty_rclpy(tmp_path / "opt" / "ros" / "jazzy"))

    assert compiled(checkout) == 0


def test_wheels_of_a_release_are_installed_before_anything_is_compiled(checkout: Checkout) -> None:
    name = "rmw_lockstep_prebuilt-0.1.0+12-py3-none-manylinux_2_28_x86_64.whl"
    (checkout.folder / "wheels").mkdir()
    (checkout.folder / "wheels" / name).touch()
    (checkout.folder / "wheels" / "spinbook-0.1.0-py3-none-any.whl").touch()

    checkout.set_up()

    installed = [number for number, call in enumerate(checkout.calls) if "--no-index" in call]
    assert [f"wheels/{name}" in checkout.calls[number] for number in installed] == [True]
    assert installed[0] < checkout.calls.index("compile") < checkout.calls.index("interfaces ")
