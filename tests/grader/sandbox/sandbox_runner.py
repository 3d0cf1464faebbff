"""A runner in a process of its own, for tests, which runs what a test passes to it.

Also as a user who is not root, when the tests are run as root: the runner's process then first changes its user.
"""

from __future__ import annotations

import json
import multiprocessing
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from grader.sandbox import ForkServer, Isolation, Limits, ProcessExit, ProgramSpec, available, syscalls

NOBODY = 65534


@dataclass(frozen=True)
class Run:
    """How a program ended and what it printed."""

    exit: ProcessExit | None
    text: str


class Runner:
    """A runner's process as a test sees it: functions of a test module are run in there."""

    def __init__(self, level: Isolation, *, rootless: bool) -> None:
        """Start it."""
        self.level = level
        self.rootless = rootless
        # A program that outlives its runner may still write there while it is removed.
        self._home = tempfile.TemporaryDirectory(prefix="nobody-", ignore_cleanup_errors=True) if rootless else None
        home = self._home and self._home.name
        context = multiprocessing.get_context("spawn")
        self._connection, theirs = context.Pipe()
        self._process = context.Process(target=_serve, args=(theirs, level, home), daemon=False)
        self._process.start()
        theirs.close()

    def do(self, function: Callable[..., Any], *arguments: object) -> Any:
        """Call `function(fork server, level, *arguments)` in the runner and return what it returns."""
        self._connection.send((function, arguments))
        fault, result = self._connection.recv()
        if fault is not None:
            raise AssertionError(f"in the runner's process: {fault}")
        return result

    def run(
        self,
        source: str | bytes,
        *,
        limits: Limits | None = None,
        preloaded: bool = True,
        name: str = "student.py",
        environment: Mapping[str, str] | None = None,
        timeout_s: float = 60.0,
    ) -> Run:
        """Run a program in a sandbox until its first process ends, and kill the rest."""
        content = source if isinstance(source, bytes) else source.encode()
        program = ProgramSpec(
            name, {name: content}, ("--ros-args",), environment=environment or {}, preloaded=preloaded
        )
        run: Run = self.do(run_to_end, program, limits, timeout_s)
        return run

    @property
    def pid(self) -> int:
        """The id of the runner's process."""
        assert self._process.pid is not None
        return self._process.pid

    def kill(self) -> None:
        """Kill the runner's process as the kernel would for lack of memory."""
        self._process.kill()
        self._process.join()

    def close(self) -> None:
        """End the runner."""
        self._connection.close()
        self._process.join(20)
        self.kill()
        if self._home:
            self._home.cleanup()


def run_to_end(
    fork_server: ForkServer, level: Isolation, program: ProgramSpec, limits: Limits | None, timeout_s: float
) -> Run:
    """Run a program to its end, in the runner."""
    with fork_server.start(program, level, limits) as student:
        end = student.wait(timeout_s)
    return Run(end, student.output())


def _serve(connection: Connection, level: Isolation, home: str | None) -> None:
    if home:
        become_nobody(home)
    with ForkServer() as fork_server:
        while True:
            try:
                function, arguments = connection.recv()
            except EOFError:
                return
            try:
                connection.send((None, function(fork_server, level, *arguments)))
            except Exception as fault:
                connection.send((f"{type(fault).__name__}: {fault}", None))


def become_nobody(home: str) -> None:
    """Give up root for good, with a home that the caller removes: nobody may not. The Python in use stays readable,
    even if it is in root's own home.
    """
    syscalls.unshare(syscalls.CLONE_NEWNS)
    syscalls.mount("", "/", flags=syscalls.MS_REC | syscalls.MS_PRIVATE)
    needed = {Path(path).resolve() for path in (sys.prefix, sys.base_prefix)}
    closed = {parent for path in needed for parent in path.parents if not parent.stat().st_mode & 0o001}
    for folder in sorted(closed):
        inside = [path for path in needed if path.is_relative_to(folder)]
        held = {path: os.open(path, os.O_PATH) for path in inside}
        syscalls.mount("tmpfs", str(folder), "tmpfs", 0, "mode=0755")
        for path, number in held.items():
            path.mkdir(parents=True)
            syscalls.mount(f"/proc/self/fd/{number}", str(path), flags=syscalls.MS_BIND | syscalls.MS_REC)
            os.close(number)
    os.chown(home, NOBODY, NOBODY)
    os.setgroups([])
    os.setresgid(NOBODY, NOBODY, NOBODY)
    os.setresuid(NOBODY, NOBODY, NOBODY)
    syscalls.prctl(syscalls.PR_SET_DUMPABLE, 1)  # lost with the change of user; a user who has logged in has it
    os.environ.update(HOME=home, TMPDIR=tempfile.gettempdir())
    os.chdir("/")


def reason_against(level: Isolation, rootless: bool) -> str | None:
    """Return why a level cannot be tested here; None if it can."""
    if not rootless:
        return _reasons()[level]
    if os.geteuid() != 0:
        return "the tests are not run as root: what is tested without root is the same as the case above"
    return _reasons_without_root()[level]


@cache
def _reasons() -> dict[Isolation, str | None]:
    return available()


@cache
def _reasons_without_root() -> dict[Isolation, str | None]:
    code = (
        f"import json, sys; sys.path[:0] = [{str(Path(__file__).parent)!r}, {str(Path(__file__).parents[3])!r}]\n"
        "from sandbox_runner import become_nobody\n"
        "become_nobody(sys.argv[1])\n"
        "from grader.sandbox import available\n"
        "print(json.dumps({level.value: reason for level, reason in available().items()}))"
    )
    with tempfile.TemporaryDirectory(prefix="nobody-") as home:
        said = subprocess.run([sys.executable, "-c", code, home], capture_output=True, text=True, check=False)
    assert said.returncode == 0, said.stderr
    return {Isolation(level): reason for level, reason in json.loads(said.stdout).items()}
