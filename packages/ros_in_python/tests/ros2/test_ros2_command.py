"""The command as a whole: help, delegation, what is refused before rclpy is loaded, and signals."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import sysconfig
from collections.abc import Iterator
from pathlib import Path

import click
import pytest
from click.testing import CliRunner
from ros2_terminal import Robot, Terminal

from ros_in_python.ros2.cli import Menu
from ros_in_python.ros2.command import NOUNS, ros2


@pytest.fixture
def terminal() -> Iterator[Terminal]:
    """A terminal each of whose commands is a new Python: how the command starts is the point here."""
    it = Terminal()
    yield it
    it.close()


def helps() -> list[list[str]]:
    """Return every place of the command that has help."""
    places: list[list[str]] = [[], *([noun] for noun in NOUNS)]
    for noun in NOUNS:
        group = ros2.get_command(click.Context(ros2), noun)
        if isinstance(group, Menu):
            places += [[noun, verb] for verb in group.list_commands(click.Context(group))]
    return places


@pytest.mark.parametrize("place", helps(), ids=" ".join)
def test_every_help_has_an_example(place: list[str]) -> None:
    shown = CliRunner().invoke(ros2, [*place, "--help"], prog_name="ros2")
    assert shown.exit_code == 0
    assert "\n    ros2 " in shown.output


def test_what_is_not_here_is_refused_with_what_is(terminal: Terminal) -> None:
    verb = terminal.ros2("topic", "ehco", "/a")
    assert verb.code == 2
    assert "Did you mean 'echo'?" in verb.err
    assert "There is: bw, delay, echo, find, hz, info, list, pub, type." in verb.err
    noun = terminal.ros2("component", "types")
    assert noun.code == 2
    assert "there is no 'ros2 component' here" in noun.err


def test_a_noun_without_a_verb_shows_its_help_and_is_no_error(terminal: Terminal) -> None:
    answer = terminal.ros2("topic")
    assert (answer.code, answer.err) == (0, "")
    assert "Print the messages of a topic." in answer.out


def test_a_package_is_created_and_its_xml_can_be_read(
    terminal: Terminal, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    words = ("--build-type", "ament_python", "--node-name", "talker", "my_robot", "--dependencies", "rclpy", "std_msgs")
    made = terminal.ros2("pkg", "create", *words)
    assert made.code == 0, made.err
    assert "going to create a new package\npackage name: my_robot\n" in made.out
    package = (tmp_path / "my_robot" / "package.xml").read_text()
    assert "  <depend>rclpy</depend>\n  <depend>std_msgs</depend>\n" in package
    assert "'talker = my_robot.talker:main'" in (tmp_path / "my_robot" / "setup.py").read_text()
    run = subprocess.run([sys.executable, "my_robot/my_robot/talker.py"], capture_output=True, text=True, check=True)
    assert run.stdout == "Hi from my_robot.\n"
    assert "already exists" in terminal.ros2("pkg", "create", *words).err
    assert terminal.ros2("pkg", "xml", "std_msgs", "-t", "name").out == "std_msgs\n"
    assert "<name>std_msgs</name>" in terminal.ros2("pkg", "xml", "std_msgs").out


def test_help_loads_neither_rclpy_nor_numpy() -> None:
    code = (
        "import sys; from click.testing import CliRunner; from ros_in_python.ros2.command import ros2\n"
        "for place in [[], ['topic'], ['topic', 'echo'], ['param', 'set'], ['run']]:\n"
        "    assert CliRunner().invoke(ros2, [*place, '--help']).exit_code == 0\n"
        "assert not {'rclpy', 'numpy'} & set(sys.modules), 'loaded'\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_the_daemon_is_explained(terminal: Terminal) -> None:
    for verb, words in {"status": "not running", "start": "not been started", "stop": "not running"}.items():
        answer = terminal.ros2("daemon", verb)
        assert (answer.code, words in answer.out, "none is needed" in answer.out) == (0, True, True)


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("RMW_IMPLEMENTATION", "rmw_cyclonedds_cpp", "not installed here"),
        ("ROS_DOMAIN_ID", "233", "a whole number from 0 to 232"),
        ("ROS_DOMAIN_ID", "home", "a whole number from 0 to 232"),
    ],
)
def test_an_environment_that_would_end_rclpy_is_reported(
    terminal: Terminal, monkeypatch: pytest.MonkeyPatch, name: str, value: str, words: str
) -> None:
    monkeypatch.setenv(name, value)
    answer = terminal.ros2("topic", "list")
    assert answer.code == 1
    assert answer.err.startswith(f"{name} is '{value}'")
    assert words in answer.err


def test_it_works_without_a_home(ros_domain: int, terminal: Terminal, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("HOME")
    monkeypatch.delenv("ROS_LOG_DIR", raising=False)
    assert terminal.ros2("node", "list").code == 0


# Delegation


@pytest.fixture
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A `ros2` on the PATH that prints what it was called with."""
    program = tmp_path / "bin" / "ros2"
    program.parent.mkdir()
    program.write_text(
        '#!/bin/sh\necho real "$@"; echo guard=$_ROS_WHEELS_BOOTSTRAP_COMPLETE${PYTHONSTARTUP:+ $PYTHONSTARTUP}\n'
    )
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{program.parent}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.delenv("ROS_IN_PYTHON")
    return program


@pytest.mark.usefixtures("installed")
def test_an_installed_ros2_answers_instead(terminal: Terminal) -> None:
    assert terminal.ros2("topic", "list", "-t", "--any").out == "real topic list -t --any\nguard=\n"
    assert terminal.ros2("bag", "record", "-a").out.startswith("real bag record -a\n")
    assert terminal.ros2("--help").out.startswith("real --help\n")


def in_a_shell(line: str) -> str:
    """Return what a shell prints for a line, in which the environment's own programs come first."""
    path = f"{sysconfig.get_path('scripts')}{os.pathsep}{os.environ['PATH']}"
    return subprocess.run(["sh", "-c", line], env={**os.environ, "PATH": path}, stdout=-1, text=True).stdout


def test_ros2_is_a_command_of_the_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("ROS_IN_PYTHON")
    assert in_a_shell("ros2 daemon status").startswith("The daemon is not running")


@pytest.mark.usefixtures("installed")
def test_the_environments_ros2_hands_over_to_a_real_one_with_all_variables() -> None:
    assert in_a_shell("PYTHONSTARTUP=mine.py ros2 topic list") == "real topic list\nguard= mine.py\n"


def test_another_installations_modules_do_not_reach_it(tmp_path: Path) -> None:
    for name in ("rclpy", "click", "json"):
        (tmp_path / f"{name}.py").write_text("raise ImportError('of another installation')\n")
    assert in_a_shell(f"PYTHONPATH={tmp_path} ros2 daemon status").startswith("The daemon is not running")


@pytest.mark.usefixtures("installed")
def test_the_variable_keeps_ours(terminal: Terminal, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("ROS_IN_PYTHON", "own")
    assert terminal.ros2("daemon", "status").out.startswith("The daemon is not running")


@pytest.mark.usefixtures("installed")
@pytest.mark.parametrize(("package", "name"), [("turtlesim", "turtlesim_node"), ("demo_nodes_cpp", "talker")])
def test_a_package_of_ours_stays_ours_where_the_installation_has_no_executables_of_it(
    tmp_path: Path, terminal: Terminal, monkeypatch: pytest.MonkeyPatch, package: str, name: str
) -> None:
    assert terminal.ros2("run", package, "nothing").err.startswith("No executable found\n")
    assert terminal.ros2("run", "--prefix", "nice", package, "nothing").code == 1
    packages = tmp_path / "share/ament_index/resource_index/packages"
    packages.mkdir(parents=True)
    (packages / package).touch()
    executable = tmp_path / "lib" / package / name
    executable.parent.mkdir(parents=True)
    executable.touch(mode=0o755)
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path))
    assert terminal.ros2("run", package, name).out.startswith(f"real run {package} {name}\n")


# Signals


@pytest.mark.parametrize(
    "arguments",
    [
        ["topic", "echo", "/count"],
        ["topic", "hz", "/count"],
        ["topic", "bw", "/count"],
        ["topic", "pub", "/cmd", "std_msgs/msg/String", "data: x"],
    ],
    ids=lambda arguments: arguments[1],
)
@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 2), (signal.SIGTERM, 0)])
def test_a_signal_ends_what_goes_on_without_a_word(
    standing: Robot, terminal: Terminal, arguments: list[str], number: int, code: int
) -> None:
    standing("counter")
    running = terminal.start(*arguments)
    running.lines(1)
    answer = running.stop(number)
    assert (answer.code, answer.err) == (code, "")


def test_a_signal_ends_what_waits_in_vain(ros_domain: int, terminal: Terminal) -> None:
    running = terminal.start("service", "call", "/nobody", "std_srvs/srv/Trigger")
    assert running.lines(1) == ["waiting for service to become available..."]
    answer = running.stop()
    assert (answer.code, answer.out, answer.err) == (2, "", "")


LOST = """
import os, signal, time
from ros_in_python.ros2 import cli

class Destroyed:
    def __del__(self):
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(0)

# A terminal of a page runs one command after the other in a process.
for command in ("first", "second"):
    cli.listen()
    assert cli.exit_code_of(ValueError()) is None
    try:
        Destroyed()
        time.sleep(20)
    except cli.StopSignal:
        print(command, "stopped")
"""


def test_a_signal_is_not_lost_where_python_drops_exceptions_nor_counted_for_the_next_command() -> None:
    ended = subprocess.run([sys.executable, "-c", LOST], capture_output=True, text=True, timeout=30, check=False)
    assert (ended.stdout, ended.stderr) == ("first stopped\nsecond stopped\n", "")


def test_sigint_is_heard_even_where_it_was_ignored(standing: Robot, terminal: Terminal) -> None:
    standing("counter")
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        running = terminal.start("topic", "echo", "/count")
    finally:
        signal.signal(signal.SIGINT, before)
    running.lines(1)
    assert running.stop().code == 2


def test_a_reader_that_goes_away_ends_the_command_quietly(standing: Robot, terminal: Terminal) -> None:
    standing("counter")
    running = terminal.start("topic", "echo", "/count")
    running.lines(1)
    assert running.process.stdout is not None
    running.process.stdout.close()
    assert running.process.stderr is not None
    assert running.process.stderr.read() == ""
    assert running.process.wait(60) == 1
