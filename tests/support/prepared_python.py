"""Runs commands in processes that are forked from one that has imported what the command needs.

Half a second of computing goes into the imports of `spinbook build`, each time. A forked process does without; apart
from that it is a process like any other, with a folder, an environment, output and an exit code of its own. Start a
real one where the start itself matters: the order of sets, for example, is the same in all forks of one process.

Nothing that is imported here may start a thread: threads are not in the forks. rclpy starts two, of LTTng's, which no
program needs; the grader forks beside them, too: see `fork` in grader/sandbox/zygote.py.
"""

from __future__ import annotations

import atexit
import gc
import importlib
import json
import os
import runpy
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import warnings
from functools import cache
from pathlib import Path
from typing import IO, Any

from tree import PYTHONPATH

_GRADING = ("grader.classroom.class_run", "grader.grading.grading", "grader.report.terminal")
#: What commands import only when they are under way, by their verb or module.
LATER = {
    "site": ("spinbook.site.contents", "spinbook.site.sphinx_build", "myst_nb.sphinx_ext"),
    "grade": _GRADING,
    "grader": _GRADING,
    "ros_in_python.ros2": (
        *(
            f"ros_in_python.ros2.{name}"
            for name in ("action", "graph", "interfaces", "lifecycle", "messages", "node", "param", "service")
        ),
        *(
            "ros_in_python.ros2.topic.echo",
            "ros_in_python.ros2.topic.listing",
            "numpy",
            "rclpy.action",
            "rclpy.parameter_client",
            "rosidl_generator_py",
            "sensor_msgs.msg",
            "std_msgs.msg",
        ),
    ),
}
#: The threads of LTTng's that `import rclpy` starts.
_THREADS_OF_RCLPY = 2
#: The largest request, in bytes: most of it is the environment.
_LARGEST = 1 << 17
_TIME_LIMIT_S = 560.0


def run_prepared(
    module: str,
    *words: str,
    cwd: Path | None = None,
    env: dict[str, str] | None = None,
    text: str = "",
    limit_s: float = _TIME_LIMIT_S,
    merged: bool = False,
) -> subprocess.CompletedProcess[str]:
    """Run `python -m module words`, with `text` as its input; `merged` is whether errors are part of its output.

    Raises TimeoutExpired.
    """
    request = {
        "needs": _needs(module, words),
        "module": module,
        "words": words,
        "cwd": os.fspath(cwd or Path.cwd()),
        "env": dict(os.environ if env is None else env),
    }
    with tempfile.TemporaryFile() as stdin, tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        stdin.write(text.encode())
        stdin.seek(0)
        code = _prepared(module).run(request, (stdin, out, out if merged else err), limit_s)
        return subprocess.CompletedProcess([module, *words], code, _content(out), _content(err))


def _needs(module: str, words: tuple[str, ...]) -> list[str]:
    """Return what to import before the fork."""
    if module != "spinbook":
        return [f"{module}.command", *LATER.get(module, ())]
    from spinbook.cli import VERBS

    verb = words[0] if words else ""
    return [VERBS[verb].command.partition(":")[0] if verb in VERBS else "spinbook.cli", *LATER.get(verb, ())]


def _content(file: IO[bytes]) -> str:
    file.seek(0)
    return file.read().decode()


@cache
def _prepared(module: str) -> PreparedPython:
    return PreparedPython()


class PreparedPython:
    """A process that forks for each command, and ends with the process that started it."""

    def __init__(self) -> None:
        self._control, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        # What one test has in its environment is not for the others.
        env = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHONPATH", "SPINBOOK_"))}
        env["PYTHONPATH"] = PYTHONPATH
        env["OPENBLAS_NUM_THREADS"] = "1"  # numpy would start a thread
        with theirs:
            argv = [sys.executable, __file__, str(theirs.fileno())]
            self._process = subprocess.Popen(argv, env=env, pass_fds=[theirs.fileno()])
        atexit.register(self.close)

    def run(self, request: dict[str, Any], files: tuple[IO[bytes], ...], limit_s: float) -> int:
        """Run a command; return its exit code. Raises TimeoutExpired."""
        socket.send_fds(self._control, [json.dumps(request).encode()], [file.fileno() for file in files])
        pid = self._answer()
        self._control.settimeout(limit_s)
        try:
            return os.waitstatus_to_exitcode(self._answer())
        except TimeoutError:
            os.kill(pid, signal.SIGKILL)
            self._control.settimeout(None)
            self._answer()
            raise subprocess.TimeoutExpired(request["words"], limit_s) from None
        finally:
            self._control.settimeout(None)

    def _answer(self) -> int:
        answer = self._control.recv(64)
        assert answer, "the prepared Python has ended: what it has to import can't be imported"
        return int(answer)

    def close(self) -> None:
        """End the process."""
        self._control.close()
        self._process.wait()


def _serve(control: socket.socket) -> dict[str, Any]:
    """Fork for each request; return it in the fork."""
    while True:
        data, files, *_ = socket.recv_fds(control, _LARGEST, 3)
        if not data:
            os._exit(0)
        request: dict[str, Any] = json.loads(data)
        for name in request["needs"]:
            importlib.import_module(name)
        threads = len(list(Path("/proc/self/task").iterdir()))
        assert threads == 1 + _THREADS_OF_RCLPY * ("rclpy" in sys.modules), f"{request['needs']} start a thread"
        gc.freeze()
        if not (pid := _fork()):
            control.close()
            for number, file in enumerate(files):
                os.dup2(file, number)
                os.close(file)
            return request
        for file in files:
            os.close(file)
        control.send(str(pid).encode())
        control.send(str(os.waitpid(pid, 0)[1]).encode())


def _fork() -> int:
    """Fork as `os.fork` does, without Python 3.12's warning of threads."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", "This process .* is multi-threaded", DeprecationWarning)
        return os.fork()


def _become(request: dict[str, Any]) -> None:
    """Be as a new Python that was started with the request's folder and environment."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    os.chdir(request["cwd"])
    os.environ.clear()
    os.environ.update(request["env"])
    given = [entry for entry in os.environ.get("PYTHONPATH", "").split(os.pathsep) if entry]
    sys.path[:0] = [request["cwd"], *given]
    importlib.invalidate_caches()
    sys.argv = [request["module"], *request["words"]]


def main() -> None:
    """Serve; in a fork, run the command."""
    # Ctrl-C is for the commands; this process ends when nobody can ask it for anything any more.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    sys.path.remove(os.fspath(Path(__file__).parent))
    request = _serve(socket.socket(fileno=int(sys.argv[1])))
    _become(request)
    _end(_code_of(request["module"]))


def _code_of(module: str) -> int:
    """Run the module as a program; return its exit code."""
    try:
        runpy.run_module(module, run_name="__main__", alter_sys=True)
    except SystemExit as stop:
        if isinstance(stop.code, str):
            print(stop.code, file=sys.stderr)
        return stop.code if isinstance(stop.code, int) else int(stop.code is not None)
    except Exception:
        sys.excepthook(*sys.exc_info())
        return 1
    return 0


def _end(code: int) -> None:
    """End as Python ends, but let the kernel clear the memory: Python would first copy each page that the fork shares.

    That is nine tenths of what a short command takes.
    """
    threading._shutdown()  # type: ignore[attr-defined]  # waits for threads
    atexit._run_exitfuncs()
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)


if __name__ == "__main__":
    main()
