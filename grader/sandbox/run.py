"""Runs a student's file as Python itself would run it, in a process that has imported rclpy already."""

from __future__ import annotations

import atexit
import builtins
import importlib.machinery
import io
import os
import signal
import sys
import types
from pathlib import Path
from typing import NoReturn

from . import middleware, view
from .program import Place, Program

#: How many cores a program is told of. It runs on one, but rclpy's MultiThreadedExecutor takes this for its number of
#: threads, and with one thread a program would be stuck here that works on every other machine.
CORES_SHOWN = 4


def run(program: Program, place: Place) -> None:
    """Runs a program as `__main__` in this process; returns or raises SystemExit as the program does.

    Its first act is to connect to the hub, if it has one. So a program that ended without a connection has done nothing
    of the student's: that is a fault of the machine's or ours.

    An uncaught exception prints its traceback, beginning with the student's own lines, and exits with 1; an uncaught
    KeyboardInterrupt ends the process by SIGINT. Threads, atexit and the rest of the end are the interpreter's own.
    """
    path = str(Path(place.folder, program.main))
    variables = view.environment(program, place)
    os.environ.clear()
    os.environ.update(variables)
    if not program.warm:
        os.execv(sys.executable, [sys.executable, path, *program.arguments])
    if place.hub:
        middleware.connect(place.hub)
    module = _prepare(path, program.arguments)
    os.sched_getaffinity = lambda pid: set(range(CORES_SHOWN))
    try:
        exec(compile(Path(path).read_bytes(), path, "exec", dont_inherit=True), module.__dict__)
    except SystemExit:
        raise
    except BaseException as fault:
        _die_of(fault)


def _prepare(path: str, arguments: tuple[str, ...]) -> types.ModuleType:
    """Makes this interpreter look as if it had been started with the file."""
    sys.argv = [path, *arguments]
    sys.orig_argv = [sys.executable, *sys.argv]
    sys.path[0] = str(Path(path).parent)
    imported = [entry for entry in os.environ.get("PYTHONPATH", "").split(os.pathsep) if entry]
    sys.path[1:1] = [entry for entry in imported if entry not in sys.path]
    sys.path_importer_cache.clear()
    for name, number, mode in (("stdin", 0, "r"), ("stdout", 1, "w"), ("stderr", 2, "w")):
        errors = "surrogateescape" if mode == "r" else "backslashreplace"
        binary = io.FileIO(number, mode, closefd=False)
        buffered = io.BufferedReader(binary) if mode == "r" else io.BufferedWriter(binary)
        # By the line, as on a terminal, so that what was printed is there when the program is killed.
        stream = io.TextIOWrapper(buffered, "utf-8", errors, line_buffering=True)
        setattr(sys, name, stream)
        setattr(sys, f"__{name}__", stream)
    module = types.ModuleType("__main__")
    module.__file__ = path
    module.__loader__ = importlib.machinery.SourceFileLoader("__main__", path)
    module.__dict__["__builtins__"] = builtins
    module.__dict__["__cached__"] = None
    atexit.register(_die_of_interrupt)  # the first to be registered is the last to be called
    _ours.append(sys.modules["__main__"])
    sys.modules["__main__"] = module
    for name in [name for name in sys.modules if name.partition(".")[0] in ("grader", "rmw_lockstep")]:
        _ours.append(sys.modules.pop(name))
    return module


# The modules whose code is still running below the student's: without a reference they would be torn down.
_ours: list[types.ModuleType] = []
# Not empty when an uncaught KeyboardInterrupt ends the program.
_interrupted: list[bool] = []


def _die_of(fault: BaseException) -> NoReturn:
    """Prints an exception as an interpreter does that ends with it, without the lines of this file."""
    trace = fault.__traceback__.tb_next if fault.__traceback__ is not None else None
    _interrupted.extend([True] if isinstance(fault, KeyboardInterrupt) else [])
    sys.excepthook(type(fault), fault.with_traceback(trace), trace)
    sys.exit(1)


def _die_of_interrupt() -> None:
    if not _interrupted:
        return
    sys.stdout.flush()
    sys.stderr.flush()
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    os.kill(os.getpid(), signal.SIGINT)
