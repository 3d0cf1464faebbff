"""The middleware of the programs under test: whether this machine has it, and the type support they need."""

from __future__ import annotations

import contextlib
import ctypes
import importlib
import inspect
import os
import sys
from collections.abc import Callable, Mapping
from pathlib import Path

from grader.sandbox.program import SandboxUnavailable
from rmw_lockstep.library import Library, UnavailableLibrary, library
from rmw_lockstep.ros import installed_ros


class MiddlewareUnavailable(SandboxUnavailable):
    """Raised if the grader's middleware is not available on this machine."""


def _on_stderr(text: str) -> None:
    print(text, file=sys.stderr, flush=True)


def require_middleware(announce: Callable[[str], None] = _on_stderr) -> None:
    """Make sure that the grader's middleware is available. Compile it if this machine has none, and `announce` that.

    Raises `MiddlewareUnavailable` if it is neither installed nor can be compiled here.
    """
    if isinstance(library(), Library):
        return
    from rmw_lockstep.build import BuildError, build  # the processes that become students must not compile

    try:
        built = build(lambda: announce("Compiling the grader's middleware, once: about 20 s ..."))
    except BuildError as error:
        raise MiddlewareUnavailable(
            f"The grader's middleware could not be compiled: {error.first}. For the compiler's full output, run "
            f"{sys.executable} -m rmw_lockstep.build"
        ) from None
    if isinstance(built, UnavailableLibrary):
        raise MiddlewareUnavailable(f"The grader's middleware is missing: {built.reason}. {built.remedy}")


def variables(of: Mapping[str, str]) -> dict[str, str]:
    """Return the variables that a process needs to load the middleware, given its other environment.

    Raises `MiddlewareUnavailable` if it has not been compiled.
    """
    built = library()
    if isinstance(built, UnavailableLibrary):
        raise MiddlewareUnavailable(f"The grader's middleware is missing: {built.reason}. {built.remedy}")
    return built.environment(of)


def choosable() -> bool:
    """Return whether `RMW_IMPLEMENTATION` chooses the middleware. PyPI's wheels load theirs by a fixed file name.

    With those, rcl ends the process if the variable names another one than was loaded.
    """
    ros = installed_ros()
    return ros is not None and ros.chooses_at_run_time


def library_folder() -> Path | None:
    """Return the folder of the compiled middleware, which sandboxes show; None if there is none."""
    found = library()
    return found.folder if isinstance(found, Library) else None


_this_process = ctypes.CDLL(None)


def connect(hub: str) -> None:
    """Connect this process, into which liblockstep was preloaded, to the hub; from now on the hub sets its time.

    Raises OSError if there is no hub, or it does not answer.
    """
    error = _this_process.lockstep_connect(os.fsencode(hub))
    if error:
        raise OSError(error, f"no connection to the hub {hub}: {os.strerror(error)}")


def load_type_support(name: str) -> None:
    """Import a module of message or service types, and load their compiled type support.

    Failures are ignored: they occur again when the type is used.
    """
    try:
        module = importlib.import_module(name)
        from rclpy.serialization import serialize_message
    except ImportError:
        return
    for _, kind in inspect.getmembers(module, inspect.isclass):
        load_own = getattr(kind, "__import_type_support__", None)
        if load_own is not None:
            with contextlib.suppress(Exception):
                load_own()
                if name.endswith(".msg"):
                    serialize_message(kind())
