"""A student's program sees Python, ROS 2 and its own file, and nothing else of this machine."""

from __future__ import annotations

import json
import os
import socket
import sys
import sysconfig
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from sandbox_runner import Runner

from grader.sandbox import ForkServer, Isolation, ProgramSpec

ROOT = Path(__file__).parents[3]
SECRET = "the expected velocities are 0.5"


@pytest.fixture
def secret_file() -> Iterator[Path]:
    """A file that every user of this machine may read."""
    path = Path("/tmp", f"hidden-checks-{os.getpid()}-{threading.get_ident()}.py")
    path.write_text(SECRET)
    path.chmod(0o644)
    yield path
    path.unlink()


def answer(runner: Runner, code: str, **arguments: Any) -> Any:
    """Return what a program prints as JSON."""
    run = runner.run("import json, os, sys\n" + code, **arguments)
    try:
        return json.loads(run.text)
    except ValueError:
        raise AssertionError(f"{run.exit}: {run.text}") from None


def test_no_file_of_this_machine_can_be_read(confined_runner: Runner, secret_file: Path) -> None:
    paths = [str(secret_file), "/etc/shadow", "/etc/hostname", f"{Path.home()}/.bashrc", str(ROOT / "pyproject.toml")]
    paths += [str(ROOT / "exercises/joint_velocity/hidden_checks.py"), str(ROOT / "solutions"), __file__]
    code = f"""
read = []
for path in {paths!r}:
    try:
        read.append(os.listdir(path) if os.path.isdir(path) else open(path).read())
    except OSError:
        pass
print(json.dumps(read))"""

    assert answer(confined_runner, code) == []


def test_only_known_folders_are_there(apart_runner: Runner) -> None:
    seen = set(answer(apart_runner, "print(json.dumps(os.listdir('/')))"))

    always = {"bin", "dev", "etc", "home", "lib", "lib64", "proc", "sbin", "submission", "tmp", "usr"}
    elsewhere = {"lib32", "libx32", "opt"}
    python = {Path(path).parts[1] for path in (sys.prefix, sys.base_prefix, str(Path(sys.executable).resolve()))}
    assert seen <= always | elsewhere | python


def way_to_python() -> set[str]:
    """Return what has to be in the program's own /tmp, because this checkout and its Python are in the machine's."""
    shown = [Path(place) for place in (sys.prefix, sys.base_prefix, ROOT)]
    return {place.parts[2] for place in shown if place.parts[:2] == ("/", "tmp")}


def test_the_program_finds_itself_in_an_empty_home(confined_runner: Runner) -> None:
    home, files, temporary = answer(
        confined_runner,
        "print(json.dumps([os.listdir(os.environ['HOME']), os.listdir(os.path.dirname(__file__)),"
        " os.listdir(os.environ['TMPDIR'])]))",
    )

    assert home == []
    assert files == ["student.py"]
    assert set(temporary) <= way_to_python()


def test_nothing_can_be_written_but_in_its_own_places(confined_runner: Runner) -> None:
    places = ["/", "/etc", "/usr/lib", "/home", "/dev", "/submission", sys.prefix, sysconfig.get_path("purelib")]
    places += [str(ROOT), str(ROOT / "grader"), "/var/tmp", "/run", "/proc/self", "/sys/fs/cgroup"]
    code = f"""
written = []
for place in {places!r} + [os.path.dirname(__file__)]:
    try:
        open(os.path.join(place, 'written-by-student'), 'w').close()
        written.append(place)
    except OSError:
        pass
try:
    open(__file__, 'a').close()
    written.append(__file__)
except OSError:
    pass
for place in (os.environ['HOME'], os.environ['TMPDIR']):
    open(os.path.join(place, 'mine'), 'w').close()
print(json.dumps(written))"""

    # Below /tmp, which is the program's own, the folders on the way to Python are its own too; Python is not.
    on_the_way = {str(ROOT), sys.prefix} if way_to_python() else set()
    assert set(answer(confined_runner, code)) <= on_the_way
    assert not [place for place in places if Path(place, "written-by-student").exists()]


def test_what_one_start_writes_is_gone_in_the_next(confined_runner: Runner) -> None:
    confined_runner.run(
        "import os\nfor v in ('HOME', 'TMPDIR'): open(os.path.join(os.environ[v], 'note'), 'w').close()"
    )
    places = "[os.environ['HOME'], os.environ['TMPDIR'], '/tmp', '/dev/shm']"

    names = answer(
        confined_runner,
        f"found = []\nfor place in {places}:\n    try: found += os.listdir(place)\n    except OSError: pass\n"
        "print(json.dumps(found))",
    )

    assert "note" not in names


def test_only_its_own_processes_are_there(apart_runner: Runner) -> None:
    processes = answer(apart_runner, "print(json.dumps([n for n in os.listdir('/proc') if n.isdigit()]))")

    assert len(processes) <= 3  # the process that holds the namespace open, and the program itself


def test_no_process_outside_can_be_looked_into_or_signalled(confined_runner: Runner) -> None:
    code = f"""
done = []
for what in ('environ', 'mem', 'maps', 'cwd', 'root', 'fd/0'):
    path = f'/proc/{confined_runner.pid}/{{what}}'
    try:
        done.append(os.readlink(path) if what in ('cwd', 'root', 'fd/0') else open(path, 'rb').read(1).hex())
    except OSError:
        pass
for number in (0, 15, 9):
    try:
        os.kill({confined_runner.pid}, number)
        done.append(number)
    except OSError:
        pass
print(json.dumps(done))"""

    assert answer(confined_runner, code) == []


def test_what_holds_its_namespace_open_is_no_use_to_it(apart_runner: Runner) -> None:
    code = """
found = []
for process in [n for n in os.listdir('/proc') if n.isdigit() and int(n) != os.getpid()]:
    status = dict(line.split(':', 1) for line in open(f'/proc/{process}/status').read().splitlines())
    found.append([int(status[name], 16) for name in ('CapPrm', 'CapBnd', 'NoNewPrivs', 'Seccomp')])
try:
    os.kill(1, 9)
except PermissionError:
    pass
print(json.dumps(found))
"""
    reported = answer(apart_runner, code)

    assert reported
    assert all(one == [0, 0, 1, 2] for one in reported)


def test_it_has_no_capability_and_gains_none(confined_runner: Runner) -> None:
    code = """
import ctypes
libc = ctypes.CDLL(None, use_errno=True)
header, data = (ctypes.c_uint32 * 2)(0x20080522, 0), (ctypes.c_uint32 * 6)()
libc.capget(header, data)
tried = {
    'mount': libc.mount(b'tmpfs', b'/tmp', b'tmpfs', 0, None),
    'unshare': libc.unshare(0x10000000),
    'chroot': libc.chroot(b'/tmp'),
    'sethostname': libc.sethostname(b'x', 1),
    'ptrace': libc.ptrace(16, os.getppid() or 1, 0, 0),
    'keyctl': libc.syscall(250, 0, -3, 1),
    'bpf': libc.syscall(321, 0, 0, 0),
    'userfaultfd': libc.syscall(323, 0),
    'io_uring': libc.syscall(425, 1, ctypes.create_string_buffer(256)),
    'memfd': libc.syscall(319, b'x', 0),
    'shmget': libc.shmget(0, 4096, 0o600),
}
print(json.dumps([list(data), libc.prctl(39, 0, 0, 0, 0), tried]))"""

    capabilities, no_new_privileges, tried = answer(confined_runner, code)

    assert capabilities == [0] * 6
    assert no_new_privileges == 1
    assert set(tried.values()) == {-1}


def test_setuid_programs_give_nothing(apart_runner: Runner) -> None:
    code = """
import glob, subprocess
found = [p for p in ('/usr/bin/su', '/usr/bin/mount', '/usr/bin/passwd') if os.path.exists(p)]
print(json.dumps([subprocess.run([p, '--version'], capture_output=True).returncode >= 0 for p in found] and
    [os.statvfs(p).f_flag & os.ST_NOSUID for p in found]))"""

    assert 0 not in answer(apart_runner, code)


def test_a_server_of_this_machine_is_not_reached(apart_runner: Runner) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
        code = f"""
import socket
try:
    socket.create_connection(('127.0.0.1', {port}), 5)
    print(json.dumps('connected'))
except OSError:
    print(json.dumps('refused'))"""

        assert answer(apart_runner, code) == "refused"


@pytest.mark.parametrize("family", ["AF_VSOCK", "AF_PACKET", "AF_ALG", "AF_BLUETOOTH", "AF_CAN"])
def test_no_other_kind_of_socket_exists(confined_runner: Runner, family: str) -> None:
    code = f"""
import socket
try:
    socket.socket(getattr(socket, {family!r}), socket.SOCK_RAW if {family!r} == 'AF_PACKET' else socket.SOCK_STREAM)
    print(json.dumps('made'))
except (OSError, AttributeError) as error:
    print(json.dumps('refused'))"""

    assert answer(confined_runner, code) == "refused"


def test_shared_memory_is_its_own(apart_runner: Runner) -> None:
    mark = Path("/dev/shm", f"spinbook-test-{os.getpid()}")
    mark.write_text("x")
    try:
        assert answer(apart_runner, "print(json.dumps(os.listdir('/dev/shm')))") == []
        apart_runner.run("open('/dev/shm/student-was-here', 'w').close()")
        assert not Path("/dev/shm/student-was-here").exists()
    finally:
        mark.unlink()


def look(
    fork_server: ForkServer, level: Isolation, paths: list[str], readonly: list[str], hidden: list[str]
) -> list[str | None]:
    """Return what a program reads in files, with those shown and these hidden."""
    code = f"""
import json
def read(path):
    try: return open(path).read()
    except OSError: return None
print(json.dumps([read(path) or None for path in {paths!r}]))"""
    program = ProgramSpec(
        "p.py", {"p.py": code.encode()}, readonly=tuple(map(Path, readonly)), hidden=tuple(map(Path, hidden))
    )
    with fork_server.start(program, level) as student:
        student.wait(30.0)
    reported: list[str | None] = json.loads(student.output())
    return reported


def test_a_folder_that_is_shown_is_seen_without_what_is_hidden_in_it(confined_runner: Runner, tmp_path: Path) -> None:
    course = Path("/tmp", f"course-{os.getpid()}-{tmp_path.name}")
    (course / "secret").mkdir(parents=True)
    try:
        for name in ("open.txt", "secret/checks.py", "one_secret.py"):
            (course / name).write_text(name)
        paths = [str(course / name) for name in ("open.txt", "secret/checks.py", "one_secret.py")]

        seen = confined_runner.do(look, paths, [str(course)], [str(course / "secret"), str(course / "one_secret.py")])

        assert seen == ["open.txt", None, None]
    finally:
        for path in sorted(course.rglob("*"), reverse=True):
            path.unlink() if path.is_file() else path.rmdir()
        course.rmdir()


def test_what_is_hidden_in_the_python_installation_is_not_seen(confined_runner: Runner) -> None:
    libraries = Path(sysconfig.get_path("purelib"))
    click, rich = libraries / "click/__init__.py", libraries / "rich/__init__.py"

    seen = confined_runner.do(look, [str(click), str(rich)], [], [str(click.parent)])

    assert seen[0] is None
    assert seen[1] is not None


def test_what_pypi_lacks_of_ros_2_can_be_imported(confined_runner: Runner) -> None:
    code = (
        "import cv_bridge, message_filters, rosbag2_py, tf2_geometry_msgs, tf2_ros\n"
        "from rosidl_runtime_py.utilities import get_message\n"
        "print(json.dumps(get_message('std_msgs/msg/String').__name__))"
    )
    assert answer(confined_runner, code) == "String"
