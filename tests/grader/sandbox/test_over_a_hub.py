"""Over the grader's own middleware a program talks to its hub and to nothing else: it has no network at all."""

from __future__ import annotations

import json
import os
import shutil
import socket
import tempfile
from pathlib import Path
from typing import Any

import pytest
from over_hub import HubRun, in_the_runner, run_over_hub
from sandbox_runner import Runner

from grader.sandbox import ForkServer, Isolation, ProgramSpec, SandboxError, middleware, zygote_start
from rmw_lockstep.library import Library, library

NAME_IT = "import rclpy; print(rclpy.get_rmw_implementation_identifier())"


def answer(runner: Runner, code: str) -> Any:
    """Return what a program prints as JSON."""
    run = run_over_hub(runner, "import asyncio, json, os, socket, subprocess, sys\n" + code)
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


def middleware_in(fork_server: ForkServer, level: Isolation, program: ProgramSpec, folder: Path) -> HubRun:
    """Run a program in the runner, with a copy of the middleware that is in this folder."""
    found = library()
    assert isinstance(found, Library)
    shutil.copytree(found.folder, folder)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(middleware, "library", lambda: Library(folder, found.prefix))
        with ForkServer() as own:
            return in_the_runner(own, level, program, None, 60.0)


def test_its_folder_may_have_spaces(strongest_runner: Runner, tmp_path: Path) -> None:
    program = ProgramSpec("student.py", {"student.py": f"{NAME_IT}\nrclpy.init()".encode()}, ("--ros-args",))

    run = strongest_runner.do(middleware_in, program, tmp_path / "Übung 1")

    assert (run.text, run.exit.code) == ("rmw_lockstep_cpp\n", 0)


def test_a_sleep_takes_no_time(either_runner: Runner) -> None:
    code = "import time\nbegan = time.time()\ntime.sleep(3600)\nprint(time.time() - began)"

    assert run_over_hub(either_runner, code).text == "3600.0\n"


def test_a_program_that_it_starts_itself_lives_in_the_time_of_the_hub_too(confined_runner: Runner) -> None:
    child = f"{NAME_IT}; import time; began = time.time(); time.sleep(60); print(time.time() - began)"
    code = f"import subprocess, sys\nsubprocess.run([sys.executable, '-c', {child!r}], check=True)"

    assert run_over_hub(confined_runner, code).text == "rmw_lockstep_cpp\n60.0\n"


def test_it_can_make_no_socket(confined_runner: Runner) -> None:
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

    assert answer(confined_runner, code) == []


def test_it_can_make_pairs_of_sockets_but_none_that_send_elsewhere(confined_runner: Runner) -> None:
    code = """
made = []
for kind in (socket.SOCK_STREAM, socket.SOCK_DGRAM, socket.SOCK_RAW, socket.SOCK_SEQPACKET):
    try:
        socket.socketpair(socket.AF_UNIX, kind)
        made.append(kind)
    except OSError:
        pass
asyncio.run(asyncio.sleep(0))
print(json.dumps(made))"""

    assert answer(confined_runner, code) == [socket.SOCK_STREAM, socket.SOCK_SEQPACKET]


@pytest.mark.parametrize("abstract", [False, True], ids=["with a path", "abstract"])
def test_a_unix_socket_of_the_machine_is_not_reached(any_runner: Runner, abstract: bool) -> None:
    with tempfile.TemporaryDirectory(prefix="served-") as folder, socket.socket(socket.AF_UNIX) as server:
        Path(folder).chmod(0o755)
        name = f"\0spinbook-test-{os.getpid()}" if abstract else f"{folder}/socket"
        server.bind(name)
        server.listen()
        if not abstract:
            Path(name).chmod(0o777)
        code = f"""
done = []
def reach(connect):
    try:
        connect({name!r})
        done.append('connected')
    except OSError as error:
        done.append('refused')
reach(lambda name: socket.socket(socket.AF_UNIX).connect(name))
reach(socket.socketpair()[0].connect)
reach(lambda name: socket.socketpair(type=socket.SOCK_DGRAM)[0].connect(name))
print(json.dumps(done))"""

        found = answer(any_runner, code)

    connected = any_runner.level is Isolation.NONE
    assert found == ["connected" if connected else "refused", "refused", "refused"]


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


def test_of_the_hub_it_has_one_inherited_socket_and_no_path(confined_runner: Runner) -> None:
    code = "print(json.dumps([os.environ['RMW_LOCKSTEP_SOCKET'], os.path.exists('/run/lockstep')]))"

    assert answer(confined_runner, code) == ["fd:1000", False]


def test_programs_that_it_starts_are_connected_even_if_it_closed_that_socket(confined_runner: Runner) -> None:
    code = """
os.close(1000)
os.closerange(900, 1100)
child = [sys.executable, '-c', "import time; before = time.time(); time.sleep(60); print(time.time() - before)"]
print(json.dumps(subprocess.run(child, capture_output=True, text=True).stdout))"""

    assert answer(confined_runner, code) == "60.0\n"


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
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(zygote_start, "variables", lambda of: {"RMW_IMPLEMENTATION": "rmw_lockstep_cpp"})
        with pytest.raises(SandboxError) as caught, ForkServer() as wrong:
            wrong.start(ProgramSpec("student.py", {"student.py": b""}, hub=0), level)
    return str(caught.value)


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
