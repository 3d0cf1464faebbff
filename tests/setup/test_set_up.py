"""Set-up makes an environment once, brings it up to date, and goes on if it was interrupted."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from setup_stage import Checkout, make_checkout


def pips(checkout: Checkout) -> list[str]:
    return [call for call in checkout.calls if call.startswith("pip ")]


def test_first_installs_the_pins_by_hash_and_then_spinbook_itself(checkout: Checkout) -> None:
    code, said = checkout.set_up()
    assert code == 0, said
    assert checkout.calls[0] == "venv .venv"
    build_tool, pins, itself = pips(checkout)
    assert "--require-hashes" in build_tool
    assert "--no-deps --require-hashes" in pins
    assert "-r .venv/pins-00.txt" in pins
    assert (checkout.folder / ".venv" / "pins-00.txt").read_text().count("--hash") == 3
    assert "--editable ." in itself


def test_the_build_tool_is_the_pinned_setuptools(checkout: Checkout) -> None:
    checkout.set_up()
    pinned = (checkout.folder / ".venv" / "build-tool.txt").read_text()
    assert pinned == "setuptools==79.0.1 \\\n    --hash=sha256:0\n"


def test_says_little_where_all_is_well(checkout: Checkout) -> None:
    _, said = checkout.set_up()
    first, second = said.splitlines()
    assert "about a minute" in first
    assert "Compiling example_interfaces, tf2_msgs and turtlesim" in second


def test_a_second_run_does_nothing_and_says_nothing(checkout: Checkout) -> None:
    checkout.set_up()
    checkout.forget_calls()
    assert checkout.set_up() == (0, "")
    assert checkout.calls == []


def test_what_only_tests_need_is_installed_once_and_only_for_them(checkout: Checkout) -> None:
    checkout.set_up()
    assert not any("pins-of-tests" in call for call in pips(checkout))
    checkout.forget_calls()
    code, said = checkout.set_up(TESTS="yes")
    assert (code, said) == (0, "Installing what the tests need ...\n")
    (pins,) = pips(checkout)
    assert "--no-deps --require-hashes" in pins
    assert (checkout.folder / ".venv" / "pins-of-tests.txt").read_text().startswith("mypy==2")
    for tests in ("yes", ""):
        assert checkout.set_up(TESTS=tests) == (0, "")


def test_changed_pins_are_installed_into_the_same_environment(checkout: Checkout) -> None:
    checkout.set_up()
    checkout.forget_calls()
    with (checkout.folder / "constraints.txt").open("a") as file:
        file.write("rich==15 \\\n    --hash=sha256:3\n")
    code, said = checkout.set_up()
    assert (code, len(pips(checkout))) == (0, 3)
    assert "have changed" in said
    assert not any(call.startswith("venv") for call in checkout.calls)
    assert checkout.set_up() == (0, "")


def test_after_an_interruption_the_next_run_goes_on_and_repeats_what_was_under_way(checkout: Checkout) -> None:
    with (checkout.folder / "constraints-ros.txt").open("a") as file:
        file.writelines(f"ros-{number}==7 \\\n    --hash=sha256:2\n" for number in range(60))
    os.mkfifo(checkout.stage / "pip-waits")
    process = checkout.start()
    deadline = time.monotonic() + 60
    for batch in range(3):
        while len(pips(checkout)) <= batch:
            assert time.monotonic() < deadline
        if batch < 2:
            (checkout.stage / "pip-waits").write_text("go\n")
    while not pips(checkout):
        assert time.monotonic() < deadline
        assert process.poll() is None
    os.killpg(process.pid, signal.SIGINT)
    process.communicate(timeout=60)
    assert process.returncode != 0
    (checkout.stage / "pip-waits").unlink()
    checkout.forget_calls()
    code, said = checkout.set_up()
    assert code == 0, said
    assert "Going on" in said
    assert not any(call.startswith("venv") for call in checkout.calls)
    _, first, second, _ = pips(checkout)
    assert "--force-reinstall" not in first
    assert "--force-reinstall" in second
    assert checkout.set_up() == (0, "")


def test_after_a_failure_the_next_run_goes_on(checkout: Checkout) -> None:
    checkout.tell("pip-fails", "ERROR: something")
    assert checkout.set_up()[0] == 1
    (checkout.stage / "pip-fails").unlink()
    checkout.forget_calls()
    assert checkout.set_up()[0] == 0
    assert not any(call.startswith("venv") for call in checkout.calls)


def test_what_does_not_load_after_set_up_is_made_anew(checkout: Checkout) -> None:
    checkout.tell("ros-fails", "ImportError: half a library")
    assert checkout.set_up()[0] == 1
    (checkout.stage / "ros-fails").unlink()
    checkout.forget_calls()
    assert checkout.set_up()[0] == 0
    assert checkout.calls[0] == "venv .venv"


def test_a_program_that_is_no_python_leaves_a_working_environment_alone(checkout: Checkout) -> None:
    checkout.set_up()
    checkout.forget_calls()
    for program in ("/bin/true", "/bin/false", "/bin/cat"):
        code, said = checkout.set_up(PYTHON=program)
        assert code == 1
        assert f"'{program}' is not a Python that works" in said
    assert checkout.calls == []
    assert checkout.set_up() == (0, "")


def test_another_checkouts_environment_is_left_alone(checkout: Checkout, tmp_path: Path) -> None:
    checkout.set_up()
    (tmp_path / "second").mkdir()
    second = make_checkout(tmp_path / "second")
    code, said = second.set_up(VENV=os.fspath(checkout.folder / ".venv"))
    assert code == 1
    assert f"the environment of another checkout, {checkout.folder}" in said
    assert checkout.set_up() == (0, "")


def test_a_checkout_that_can_not_be_written_is_named(checkout: Checkout) -> None:
    mounted = f"mount --bind {checkout.folder} {checkout.folder} && mount -o remount,bind,ro {checkout.folder} && sh"
    command = ["unshare", "--user", "--map-root-user", "--mount", "sh", "-c", f"{mounted} {checkout.folder}/setup.sh"]
    if subprocess.run([*command[:4], "true"], capture_output=True, check=False).returncode:
        pytest.skip("no namespaces here")
    done = subprocess.run(command, env=checkout.environment, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert done.stderr.strip().startswith(f"This checkout can't be written: {checkout.folder}")
    assert checkout.calls == []


def test_an_environment_without_its_python_is_made_anew(checkout: Checkout) -> None:
    checkout.set_up()
    (checkout.folder / ".venv" / "bin" / "python").unlink()
    checkout.forget_calls()
    assert checkout.set_up()[0] == 0
    assert checkout.calls[0] == "venv .venv"


def test_a_moved_checkout_gets_its_environment_anew(checkout: Checkout, tmp_path: Path) -> None:
    checkout.set_up()
    moved = Checkout(tmp_path / "elsewhere", checkout.stage, checkout.environment)
    shutil.move(checkout.folder, moved.folder)
    checkout.forget_calls()
    code, said = moved.set_up()
    assert code == 0
    assert "making it anew" in said
    assert moved.calls[0] == "venv .venv"


def test_the_environment_may_lie_elsewhere(checkout: Checkout, tmp_path: Path) -> None:
    place = tmp_path / "environments" / "spinbook"
    assert checkout.set_up(VENV=f"{place}/")[0] == 0
    assert checkout.calls[0] == f"venv {place}"
    assert not (checkout.folder / ".venv").exists()


def test_a_folder_of_somebody_elses_is_left_alone(checkout: Checkout, tmp_path: Path) -> None:
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.tex").write_text("a year's work")
    code, said = checkout.set_up(VENV=os.fspath(tmp_path / "mine"))
    assert code == 1
    assert "left alone" in said
    assert (tmp_path / "mine" / "thesis.tex").read_text() == "a year's work"
    assert checkout.calls == []


def test_two_at_once_take_turns_and_the_second_has_nothing_to_do(checkout: Checkout) -> None:
    os.mkfifo(checkout.stage / "pip-waits")
    first = checkout.start()
    deadline = time.monotonic() + 30
    while not pips(checkout):
        assert time.monotonic() < deadline
    second = checkout.start()
    assert second.stdout is not None
    assert "waiting" in second.stdout.readline()
    with (checkout.stage / "pip-waits").open("w") as gate:
        (checkout.stage / "pip-waits").unlink()
        gate.write("go\n")
    assert first.wait(30) == 0
    assert second.wait(30) == 0
    assert len(pips(checkout)) == 3
    for process in (first, second):
        process.communicate()


def test_variables_of_another_installation_do_not_matter(checkout: Checkout, tmp_path: Path) -> None:
    for module in ("enum", "platform", "sitecustomize"):
        (tmp_path / f"{module}.py").write_text("raise RuntimeError('of another installation')\n")
    settings = {"PYTHONPATH": f"{tmp_path}", "PYTHONHOME": "/nowhere", "PYTHONWARNINGS": "error", "LD_PRELOAD": "no.so"}

    code, said = checkout.set_up(_ROS_WHEELS_BOOTSTRAP_COMPLETE="1", **settings)

    assert code == 0
    assert "installation" not in said
    assert all(call.endswith("PYTHONPATH=unset guard=unset") for call in pips(checkout))


def test_make_does_it_before_its_other_work(checkout: Checkout) -> None:
    said = subprocess.run(
        ["make", "setup"],
        cwd=checkout.folder,
        env=checkout.environment | {"PYTHON": ""},
        capture_output=True,
        text=True,
        check=True,
    )
    assert "about a minute" in said.stderr
    assert len(pips(checkout)) == 3


# Which Python


def test_the_environments_own_python_is_kept_where_none_is_named(checkout: Checkout) -> None:
    checkout.set_up()
    checkout.program("python3", "#!/bin/sh\necho 'another Python was asked'; exit 1\n")
    checkout.forget_calls()
    assert checkout.set_up(PYTHON="") == (0, "")


def test_another_python_gets_an_environment_of_its_own(checkout: Checkout) -> None:
    checkout.set_up()
    mark = checkout.folder / ".venv" / ".spinbook"
    mark.write_text(mark.read_text().replace(os.path.realpath(sys.executable), "/usr/bin/python3.99"))
    code, said = checkout.set_up()
    assert code == 0
    assert "was made for something else (wheels, /usr/bin/python3.99)" in said


def test_an_active_environment_is_not_built_upon(checkout: Checkout) -> None:
    checkout.program("base-python", checkout.python.read_text().replace('"$STAGE/is-active"', '"$STAGE/never"'))
    checkout.tell("is-active", f"{checkout.stage}/bin/base-python\n")
    code, said = checkout.set_up()
    assert code == 0, said
    assert f"python {os.path.realpath(sys.executable)}" in (checkout.folder / ".venv" / ".spinbook").read_text()


def test_a_python_that_is_too_old_or_too_new_is_refused(checkout: Checkout) -> None:
    for version in ("3, 9, 2", "3, 15, 0"):
        checkout.tell("version", version)
        code, said = checkout.set_up()
        assert code == 1
        assert f"Spinbook needs Python 3.10 to 3.14, and '{os.path.realpath(sys.executable)}' is" in said
        assert "make PYTHON=python3.12" in said
        assert "Traceback" not in said


def test_a_python_that_is_not_there_is_reported(checkout: Checkout) -> None:
    code, said = checkout.set_up(PYTHON="python3.99")
    assert code == 1
    assert "There is no 'python3.99' here" in said


def test_the_middleware_is_compiled_once_and_again_when_its_sources_have_changed(checkout: Checkout) -> None:
    checkout.set_up()
    assert checkout.calls.count("compile") == 1
    checkout.forget_calls()

    source = checkout.folder / "packages/rmw_lockstep/rmw_lockstep/lockstep/core.cpp"
    source.parent.mkdir(parents=True)
    source.write_text("int changed;\n")
    assert checkout.set_up() == (0, "Compiling the grader's middleware ...\n")
    assert checkout.calls == ["compile"]
    assert checkout.set_up() == (0, "")


def test_where_it_can_not_be_compiled_set_up_succeeds_and_says_what_does_not_work(checkout: Checkout) -> None:
    checkout.tell("compiling-fails", "No middleware: g++ is not installed. Install it: sudo ...\n")

    code, said = checkout.set_up()

    assert code == 0
    assert "g++ is not installed. Install it" in said
    assert "Until then nothing can be graded or checked" in said
    (checkout.stage / "compiling-fails").unlink()
    assert checkout.set_up() == (0, "Compiling the grader's middleware ...\n")
