"""Over the grader's own middleware a program talks to its hub and to nothing else: it has no network at all."""

from __future__ import annotations

import json
import os
import socket
from pathlib import Path
from typing import Any

import pytest
from over_hub import run_over_hub
from sandbox_runner import Runner

from grader.sandbox import ForkServer, Isolation, ProgramSpec, SandboxError, fork_server

NAME_IT = "import rclpy; print(rclpy.get_rmw_implementation_identifier())"


def answer(runner: Runner, code: str) -> Any:
    """Return what a program prints as JSON."""
    run = run_over_hub(runner, "import json, os, socket, subprocess, sys\n" + code)
    try:
        return json.loads(run.text)
    except ValueError:
        raise AssertionError(f"{run.exit}: {run.text}") from None


@pytest.mark.parametrize("preloaded", [True, False], ids=["forked", "a new Python"])
def test_a_node_runs_over_it_at_each_level(any_runner: Runner, preloaded: bool) -> None:
    code = f"{NAME_IT}\nrclpy.init()\nnode = rclpy.create_node('here')\nprint(node.get_node_names())"

    run = run_over_hub(any_runner, code, preloaded=preloaded)

    assert run.text == "rmw_lockstep_cpp\n['here']\n"
    assert run.exit
    assert run.exit.code == 0


def test_a_sleep_takes_no_time(either_runner: Runner) -> None:
    code = "import time\nbegan = time.time()\ntime.sleep(3600)\nprint(time.time() - began)"

    assert run_over_hub(either_runner, code).text == "3600.0\n"


def test_a_program_that_it_starts_itself_lives_in_the_time_of_the_hub_too(confined_runner: Runner) -> None:
    child = f"{NAME_IT}; import time; began = time.time(); time.sleep(60); print(time.time() - began)"
    code = f"import subprocess, sys\nsubprocess.run([sys.executable, '-c', {child!r}], check=True)"

    assert run_over_hub(confined_runner, code).text == "rmw_lockstep_cpp\n60.0\n"


def test_it_has_unix_sockets_and_no_others(confined_runner: Runner) -> None:
    code = """
made = set()
for family in range(1, 64):
    for kind in (socket.SOCK_STREAM, socket.SOCK_DGRAM, socket.SOCK_RAW):
        try:
            socket.socket(family, kind).close()
            made.add(family)
        except OSError:
            pass
print(json.dumps(sorted(made)))"""

    assert answer(confined_runner, code) == [socket.AF_UNIX]


def test_a_program_that_it_starts_itself_has_no_others_either(confined_runner: Runner) -> None:
    code = """
child = [sys.executable, '-c', "import socket; socket.create_connection(('127.0.0.1', 80))"]
print(json.dumps(subprocess.run(child, capture_output=True, text=True).stderr))"""

    assert "Address family not supported" in answer(confined_runner, code)


def test_its_network_has_not_even_loopback(apart_runner: Runner) -> None:
    lines = answer(apart_runner, "print(json.dumps(open('/proc/net/dev').read().splitlines()[2:]))")
    addresses = answer(apart_runner, "print(json.dumps(open('/proc/net/fib_trie').read()))")

    assert [line.split(":")[0].strip() for line in lines] == ["lo"]
    assert addresses == ""


def test_a_socket_without_a_path_is_not_reached(apart_runner: Runner) -> None:
    name = f"\0spinbook-test-{os.getpid()}"
    with socket.socket(socket.AF_UNIX) as server:
        server.bind(name)
        server.listen()
        code = f"""
try:
    socket.socket(socket.AF_UNIX).connect({name!r})
    print(json.dumps('connected'))
except OSError as error:
    print(json.dumps('refused'))"""

        assert answer(apart_runner, code) == "refused"


def test_of_the_hub_it_sees_the_socket_alone_always_in_the_same_place(apart_runner: Runner) -> None:
    code = "print(json.dumps([os.environ['RMW_LOCKSTEP_SOCKET'], os.listdir('/run'), os.listdir('/run/lockstep')]))"

    assert answer(apart_runner, code) == ["/run/lockstep/hub", ["lockstep"], ["hub"]]


def test_it_can_neither_replace_nor_remove_the_socket(confined_runner: Runner) -> None:
    code = """
hub, done = os.environ['RMW_LOCKSTEP_SOCKET'], []
for attempt in (os.unlink, lambda path: os.chmod(path, 0), lambda path: os.rename(path, path + '2')):
    try:
        attempt(hub)
        done.append(True)
    except OSError:
        pass
print(json.dumps(done))"""

    # With Landlock and without root the program has its user's rights to change a mode.
    assert answer(confined_runner, code) == ([True] if confined_runner.level is Isolation.LANDLOCK else [])


def test_no_other_user_of_the_machine_reaches_the_hub(any_runner: Runner) -> None:
    folder, hub = any_runner.do(modes_while_it_runs)

    other_user = any_runner.level is Isolation.LANDLOCK and not any_runner.rootless and os.geteuid() == 0
    assert folder == (0o711 if other_user else 0o700)
    assert hub == (0o600 if other_user else 0o666)


def modes_while_it_runs(rig_fork_server: ForkServer, level: Isolation) -> tuple[int, int]:
    """Return the modes of the hub's folder and of its socket."""
    import tempfile

    from rmw_lockstep.hub import Hub

    with tempfile.TemporaryDirectory() as folder, Hub(Path(folder)) as hub:
        program = ProgramSpec("student.py", {"student.py": b""}, hub=hub.path)
        with rig_fork_server.start(program, level):
            return hub.path.parent.stat().st_mode & 0o777, hub.path.stat().st_mode & 0o777


def test_the_middleware_is_hidden_from_it(strongest_runner: Runner) -> None:
    code = """
try:
    import rmw_lockstep.hub
    print(json.dumps('there'))
except ImportError:
    print(json.dumps('hidden'))"""

    assert answer(strongest_runner, code) == "hidden"


def test_fast_dds_never_takes_its_place_unnoticed(either_runner: Runner) -> None:
    fault = either_runner.do(start_with_the_wrong_middleware)

    assert "has loaded the middleware rmw_fastrtps_cpp, not rmw_lockstep_cpp" in fault


def start_with_the_wrong_middleware(rig_fork_server: ForkServer, level: Isolation) -> str:
    """Return the runner's answer when the library that should be first is not found."""
    found = fork_server.variables
    fork_server.variables = lambda of: {"RMW_IMPLEMENTATION": "rmw_lockstep_cpp"}  # type: ignore[assignment]
    try:
        with ForkServer() as wrong:
            wrong.start(ProgramSpec("student.py", {"student.py": b""}, hub=Path("/nowhere/hub")), level)
    except SandboxError as fault:
        return str(fault)
    finally:
        fork_server.variables = found
    return "it was started"


def test_the_rest_of_the_machine_is_as_closed_as_without_a_hub(confined_runner: Runner) -> None:
    code = f"""
read = []
for path in ({__file__!r}, '/etc/shadow', {str(Path.home() / ".bashrc")!r}):
    try:
        read.append(open(path).read())
    except OSError:
        pass
print(json.dumps(read))"""

    assert answer(confined_runner, code) == []
