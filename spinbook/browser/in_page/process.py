"""A process of the page: runs a program as `python3 FILE` would, with an exit status at the end."""

from __future__ import annotations

import builtins
import errno
import importlib
import inspect
import json
import linecache
import os
import random
import sys
import threading
import time
import traceback
import types
from collections.abc import Mapping, Sequence
from typing import Any

import grader
import rcl_python
import rmw_lockstep
from grader.recording.printed_paths import with_own_frames
from rcl_python import logs, participant
from spinbook.browser.in_page import program_imports, threads
from spinbook.browser.in_page.link import PageLink

_FAILED, _INTERRUPTED = 1, 130
#: How many threads `MultiThreadedExecutor` and other pools have.
_PROCESSORS = 4
_NO_NUMPY = "This program imports {name}, which a web page does not have. It runs in a notebook and in the grader."
_NO_MEMORY = "This program needs more memory than a web page has. It runs in a notebook."
_NO_PROCESSES = "This program starts another one, which a web page can't. It runs in a notebook."
_NO_INPUT = "This program asks for input, and a web page has no terminal to type in. Use a parameter, or the notebook."
_ABSENT = ("numpy", "matplotlib", "scipy", "cv2", "pandas", "cv_bridge", "rosbag2_py", "tf_transformations")


def prepare() -> None:
    """Replace what waits in a way a page can't, and import rclpy.

    Each process of a page starts with a copy of the memory that the first one has after this call.
    """
    threads.replace_threading()
    logs.write = lambda line: print(line, file=sys.stderr)
    # Browsers do not reveal the number reliably, and Pyodide's is 1: pools would have a single thread.
    os.cpu_count = lambda: _PROCESSORS
    rcl_python.install()
    program_imports.watch()
    builtins.input = _refuse_input
    threading.excepthook = _show_error_of_thread
    import_rclpy()


def open_process(page: Any, identity: str) -> None:
    """Make this a process of its own, which joins the graph."""
    threads.use(page, lambda: link.deliver_signals())
    link = PageLink(page)
    participant.use(link, identity)
    time.sleep = link.sleep  # type: ignore[assignment]
    # The names of the `ros2` command's nodes tell its processes apart, and Pyodide gives all the same number.
    number = int(identity.lstrip("w"))
    os.getpid = lambda: number
    # With the copied state, all processes would draw the same numbers.
    random.seed()


def answer(page: Any, op: str, arguments: Mapping[str, Any]) -> str:
    """Call a function of this package, such as `cells.run_python`, and return its result as JSON.

    A function with a parameter `page` gets the worker's JavaScript side.
    """
    module, _, name = op.partition(".")
    function = getattr(importlib.import_module(f"spinbook.browser.in_page.{module}"), name)
    first = [page] if "page" in inspect.signature(function).parameters else []
    return json.dumps(function(*first, **arguments))


def _show_error_of_thread(ended: threading.ExceptHookArgs) -> None:
    """Print what ended a thread, as Python does."""
    if ended.exc_value is not None and not isinstance(ended.exc_value, SystemExit):
        print(f"Exception in thread {ended.thread.name if ended.thread else '?'}:", file=sys.stderr)
        print_error(ended.exc_value)


def print_error(error: BaseException) -> None:
    """Print an exception, and those that led to it, with the program's own frames: others help no student."""
    print(with_own_frames("".join(traceback.format_exception(error))), end="", file=sys.stderr)


def _refuse_input(prompt: object = "") -> str:
    raise RuntimeError(_NO_INPUT)


def import_rclpy() -> None:
    """Import what nearly every program imports, so that it starts at once."""
    import rclpy.executors
    import rclpy.node
    import rclpy.qos  # noqa: F401
    import std_msgs.msg  # noqa: F401


def find_grader_in(archive: str) -> None:
    """Make Python find the grader in this archive, which has all of it; other archives have only a part."""
    grader.__path__[:] = [f"{archive}/grader"]
    rmw_lockstep.__path__.append(f"{archive}/rmw_lockstep")


def run_program(source: str, file: str, args: Sequence[str], environment: Mapping[str, str]) -> int:
    """Run a program; return its exit status. Its output, tracebacks included, goes to the page."""
    os.environ.update(environment)
    become_main(source, file, args)
    program_imports.begin_program()
    return status_of(lambda: run_main(source, file))


def become_main(source: str, file: str, args: Sequence[str]) -> None:
    """Make a program `__main__`, with these arguments, as Python does with a script."""
    main = types.ModuleType("__main__")
    main.__file__ = file
    sys.modules["__main__"] = main
    sys.argv = [file, *args]
    # Tracebacks show lines of the program, which is not in a file.
    linecache.cache[file] = (len(source), None, source.splitlines(keepends=True), file)


def run_main(source: str, file: str) -> None:
    """Run the program that is `__main__`, and wait for its threads, as Python does at exit."""
    try:
        exec(compile(source, file, "exec"), sys.modules["__main__"].__dict__)
    finally:
        threads.wait_for_all()


def status_of(program: Any) -> int:
    """Call `program`; return the status with which a process would end."""
    try:
        program()
    except SystemExit as error:
        return exit_status(error.code)
    except KeyboardInterrupt as error:
        print_error(error)
        return _INTERRUPTED
    except BaseException as error:
        print_error(error)
        _explain(error)
        return _FAILED
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
    return 0


def exit_status(code: object) -> int:
    """Return the status with which `sys.exit(code)` ends a process, which prints what is no number."""
    if code is None or isinstance(code, int):
        return code or 0
    print(code, file=sys.stderr)
    return _FAILED


def _explain(error: BaseException) -> None:
    """Print one sentence about what a page does not have, if that caused the error."""
    name = (getattr(error, "name", None) or "").partition(".")[0]
    if isinstance(error, ImportError) and name in _ABSENT:
        print(_NO_NUMPY.format(name=name), file=sys.stderr)
    elif isinstance(error, MemoryError):
        print(_NO_MEMORY, file=sys.stderr)
    elif getattr(error, "errno", None) == errno.ENOTSUP or name == "_multiprocessing":
        print(_NO_PROCESSES, file=sys.stderr)
