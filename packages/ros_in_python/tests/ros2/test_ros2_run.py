"""`ros2 run` and `ros2 pkg`: executables of prefixes, of colcon workspaces, and our own."""

from __future__ import annotations

import json
import os
import signal
import stat
import sys
from pathlib import Path

import pytest
from ros2_terminal import Terminal

from ros_in_python.ros2.cli import CommandError
from ros_in_python.ros2.executables import find

PROGRAM = f"""\
#!{sys.executable}
import json, os, signal, sys
import hello_pkg
print(json.dumps({{
    "pid": os.getpid(),
    "arguments": sys.argv[1:],
    "module": hello_pkg.__file__,
    "prefixes": os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep),
}}), flush=True)
if "wait" in sys.argv:
    signal.pause()
"""


def install(workspace: Path, layout: str, *, symlinked: bool = False) -> Path:
    """Install a package `hello_pkg` as colcon does, with the executable `hello`; return the folder of its module."""
    prefix = workspace / "install" / ("hello_pkg" if layout == "isolated" else "")
    site = Path("lib", f"python{sys.version_info.major}.{sys.version_info.minor}", "site-packages")
    module = (workspace / "build" if symlinked else prefix / site) / "hello_pkg"
    share = prefix / "share" / "hello_pkg"
    program = prefix / "lib" / "hello_pkg" / "hello"
    for folder in (module, share / "hook", program.parent, prefix / "share/ament_index/resource_index/packages"):
        folder.mkdir(parents=True)
    (workspace / "install" / ".colcon_install_layout").write_text(f"{layout}\n")
    (prefix / "share/ament_index/resource_index/packages/hello_pkg").touch()
    (module / "__init__.py").touch()
    program.write_text(PROGRAM)
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
    path = str(module.parent) if symlinked else str(site)
    (share / "package.dsv").write_text("source;share/hello_pkg/hook/pythonpath.sh\nsource;share/hello_pkg/hook/p.dsv\n")
    (share / "hook" / "p.dsv").write_text(f"prepend-non-duplicate;PYTHONPATH;{path}\n")
    return module


@pytest.fixture(autouse=True)
def _not_sourced(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("AMENT_PREFIX_PATH", "PYTHONPATH"):
        monkeypatch.delenv(name, raising=False)


@pytest.mark.parametrize("layout", ["isolated", "merged"])
@pytest.mark.parametrize("symlinked", [True, False])
def test_a_package_of_a_workspace_runs_without_sourcing(
    tmp_path: Path, terminal: Terminal, layout: str, symlinked: bool
) -> None:
    module = install(tmp_path, layout, symlinked=symlinked)
    answer = terminal.ros2("run", "hello_pkg", "hello", "--ros-args", "-p", "a:=1", cwd=tmp_path)
    answered = json.loads(answer.out)
    assert answered["arguments"] == ["--ros-args", "-p", "a:=1"]
    assert Path(answered["module"]).parent == module
    assert answered["prefixes"][0].startswith(str(tmp_path / "install"))


def test_the_workspace_is_found_from_below_it_and_from_beside_it(tmp_path: Path, terminal: Terminal) -> None:
    install(tmp_path / "humanoid_ws", "isolated")
    below = tmp_path / "humanoid_ws" / "src" / "hello_pkg"
    notebooks = tmp_path / "notebooks"
    for folder in (below, notebooks, tmp_path):
        folder.mkdir(parents=True, exist_ok=True)
        assert terminal.ros2("run", "hello_pkg", "hello", cwd=folder).code == 0


def test_the_process_becomes_the_node_so_signals_are_its_own(tmp_path: Path, terminal: Terminal) -> None:
    install(tmp_path, "isolated")
    run = terminal.start("run", "hello_pkg", "hello", "wait", cwd=tmp_path)
    answered = json.loads(run.lines(1)[0])
    assert answered["pid"] == run.process.pid
    assert run.stop(signal.SIGTERM).code == -signal.SIGTERM


def test_a_node_does_not_inherit_what_python_ignores(tmp_path: Path, terminal: Terminal) -> None:
    install(tmp_path, "isolated")
    (tmp_path / "install/hello_pkg/lib/hello_pkg/hello").write_text("#!/bin/sh\ngrep SigIgn: /proc/self/status\n")
    ignored = int(terminal.ros2("run", "hello_pkg", "hello", cwd=tmp_path).out.split()[1], 16)
    assert not ignored & (1 << (signal.SIGPIPE - 1))


def test_a_prefix_command_goes_before(tmp_path: Path, terminal: Terminal) -> None:
    install(tmp_path, "isolated")
    answer = terminal.ros2("run", "--prefix", "env AMENT_PREFIX_PATH=x", "hello_pkg", "hello", cwd=tmp_path)
    assert json.loads(answer.out)["prefixes"] == ["x"]


def test_an_installed_prefix_comes_before_a_workspace(
    tmp_path: Path, terminal: Terminal, monkeypatch: pytest.MonkeyPatch
) -> None:
    install(tmp_path / "near", "merged")
    sourced = install(tmp_path / "sourced", "merged")
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path / "sourced" / "install"))
    monkeypatch.setenv("PYTHONPATH", str(sourced.parent))
    answered = json.loads(terminal.ros2("run", "hello_pkg", "hello", cwd=tmp_path / "near").out)
    assert Path(answered["module"]).parent == sourced


def test_turtlesim_is_ours_where_only_its_messages_are_installed(tmp_path: Path) -> None:
    launch = find("turtlesim", "turtlesim_node", tmp_path)
    assert launch.argv == [sys.executable, "-m", "ros_in_python.turtlesim.node"]
    assert find("turtlesim", "draw_square", tmp_path).argv[-1] == "ros_in_python.turtlesim.draw_square"
    for executable in ("mimic", "turtle_teleop_key"):
        find("turtlesim", executable, tmp_path)


def test_an_installed_turtlesim_comes_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    prefix = tmp_path / "opt"
    (prefix / "share" / "ament_index" / "resource_index" / "packages").mkdir(parents=True)
    (prefix / "share" / "ament_index" / "resource_index" / "packages" / "turtlesim").touch()
    node = prefix / "lib" / "turtlesim" / "turtlesim_node"
    node.parent.mkdir(parents=True)
    node.touch(mode=0o755)
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(prefix))
    assert find("turtlesim", "turtlesim_node", tmp_path).argv == [str(node)]


@pytest.mark.parametrize(
    ("first_line", "is_kept"),
    [
        (f"#!{sys.executable}", True),
        ("#!/usr/bin/env python", True),
        ("#!/usr/bin/env -S PYTHONUNBUFFERED=1 python -u", True),
        (f"#!/bin/sh\n'''exec' {sys.executable} \"$0\" \"$@\"\n' '''", True),
        ("#!/bin/sh\n'''exec' /opt/another/bin/python3 \"$0\" \"$@\"\n' '''", False),
        ("#!/opt/another/bin/python3", False),
        ("#!/usr/bin/env bash", False),
        ("\x7fELF", False),
    ],
)
def test_only_this_pythons_programs_inherit_what_the_wheels_have_set(
    first_line: str, is_kept: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    install(tmp_path, "isolated")
    (tmp_path / "install/hello_pkg/lib/hello_pkg/hello").write_text(f"{first_line}\n")
    searched = ["/opt/middleware", str(Path(sys.prefix, "lib")), "/opt/mine"]
    monkeypatch.setenv("_ROS_WHEELS_BOOTSTRAP_COMPLETE", "1")
    monkeypatch.setenv("LD_LIBRARY_PATH", os.pathsep.join(searched))
    monkeypatch.setenv("PATH", os.pathsep.join([str(Path(sys.executable).parent), os.environ["PATH"]]))
    env = find("hello_pkg", "hello", tmp_path).env
    assert ("_ROS_WHEELS_BOOTSTRAP_COMPLETE" in env) == is_kept
    assert env["LD_LIBRARY_PATH"].split(os.pathsep) == (searched if is_kept else ["/opt/middleware", "/opt/mine"])


def test_an_unknown_package_or_executable_is_refused_with_what_there_is(tmp_path: Path, terminal: Terminal) -> None:
    install(tmp_path, "isolated")
    package = terminal.ros2("run", "helo_pkg", "hello", cwd=tmp_path)
    assert (package.code, package.err.splitlines()[0]) == (1, "Package 'helo_pkg' not found")
    assert "hello_pkg, joint_state_publisher" in package.err
    executable = terminal.ros2("run", "hello_pkg", "helo", cwd=tmp_path)
    assert (executable.code, executable.err.splitlines()[0]) == (1, "No executable found")
    assert "Executables of hello_pkg: hello." in executable.err


def test_without_a_workspace_the_refusal_says_to_build(tmp_path: Path) -> None:
    with pytest.raises(CommandError, match=r"Package 'hello_pkg' not found\n.*colcon build"):
        find("hello_pkg", "hello", tmp_path)


def test_an_executable_whose_python_is_gone(tmp_path: Path, terminal: Terminal) -> None:
    install(tmp_path, "isolated")
    program = tmp_path / "install/hello_pkg/lib/hello_pkg/hello"
    program.write_text("#!/nowhere/python\n")
    answer = terminal.ros2("run", "hello_pkg", "hello", cwd=tmp_path)
    assert answer.code == 1
    assert "build the workspace again" in answer.err


def test_pkg(tmp_path: Path, terminal: Terminal) -> None:
    install(tmp_path, "isolated")
    names = terminal.ros2("pkg", "list", cwd=tmp_path).out.split()
    assert names == sorted(names)
    assert {"hello_pkg", "turtlesim"} <= set(names)
    assert terminal.ros2("pkg", "executables", "hello_pkg", cwd=tmp_path).out == "hello_pkg hello\n"
    path = tmp_path / "install" / "hello_pkg"
    assert terminal.ros2("pkg", "prefix", "hello_pkg", cwd=tmp_path).out == f"{path}\n"
    full = terminal.ros2("pkg", "executables", "hello_pkg", "--full-path", cwd=tmp_path).out
    assert full == f"{path}/lib/hello_pkg/hello\n"
    assert terminal.ros2("pkg", "prefix", "nopkg", cwd=tmp_path).code == 1
