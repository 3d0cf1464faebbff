"""Which middleware the programs under test use, which ones this machine has, and the type support they need."""

from __future__ import annotations

import contextlib
import ctypes
import importlib
import inspect
import os
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from grader.sandbox.program import Middleware, SandboxUnavailable
from rmw_lockstep.library import Library, Unavailable, compiler, library
from rmw_lockstep.ros import installed_ros


class MiddlewareUnavailable(SandboxUnavailable):
    """Raised when the middleware that was requested is not available on this machine."""


@dataclass(frozen=True)
class Choice:
    """A middleware; `warning` says in one sentence what is weaker than it could be, and what to do. Mostly empty."""

    middleware: Middleware
    warning: str = ""


@cache
def choose_middleware(wanted: Middleware | None = None) -> Choice:
    """Return the middleware to use: the wanted one, or otherwise lockstep if available. Compiles it at the first call.

    Raises:
        MiddlewareUnavailable: if lockstep is wanted and not available.
    """
    if wanted is Middleware.FASTDDS:
        return Choice(wanted)
    reason = _reason_against_lockstep()
    if reason is None:
        return Choice(Middleware.LOCKSTEP)
    if wanted is Middleware.LOCKSTEP:
        raise MiddlewareUnavailable(f"The middleware 'lockstep' can't be used here: {reason}")
    return Choice(
        Middleware.FASTDDS,
        "Graded over Fast DDS: the grader has to infer when a node is done, so one with threads or sleeps of its own "
        f"may get another result each time. Its own middleware can't be used here: {reason}",
    )


def to_be_compiled() -> bool:
    """Return whether `choose_middleware` will compile lockstep, which takes seconds."""
    return isinstance(library(), Unavailable) and installed_ros() is not None and compiler() is not None


def _reason_against_lockstep() -> str | None:
    from rmw_lockstep.build import BuildError, build  # the processes that become students must not compile

    try:
        found = build()
    except BuildError as error:
        return f"it could not be compiled. {error}"
    return f"{found.reason}. {found.remedy}" if isinstance(found, Unavailable) else None


def variables(middleware: Middleware, of: Mapping[str, str]) -> dict[str, str]:
    """Return what a process needs in its environment to load a middleware, given its environment without that.

    Raises:
        MiddlewareUnavailable: if it has not been compiled.
    """
    if middleware is Middleware.FASTDDS:
        return {"RMW_IMPLEMENTATION": "rmw_fastrtps_cpp"}
    return _library().environment(of)


def choosable() -> bool:
    """Return whether `RMW_IMPLEMENTATION` chooses the middleware. PyPI's wheels are bound to theirs by its file name.

    With those, rcl ends the process if the variable names another one than was loaded.
    """
    ros = installed_ros()
    return ros is not None and ros.chooses_at_run_time


def library_folder() -> Path | None:
    """Return the folder of the compiled lockstep, which sandboxes show; None if there is none."""
    found = library()
    return found.folder if isinstance(found, Library) else None


def _library() -> Library:
    found = library()
    if isinstance(found, Unavailable):
        raise MiddlewareUnavailable(f"The middleware 'lockstep' can't be used here: {found.reason}. {found.remedy}")
    return found


_this_process = ctypes.CDLL(None)


def connect(hub: str) -> None:
    """Connect this process, into which liblockstep was preloaded, to the hub; from now on the hub sets its time.

    Raises:
        OSError: if there is no hub, or it does not answer.
    """
    error = _this_process.lockstep_connect(os.fsencode(hub))
    if error:
        raise OSError(error, f"no connection to the hub {hub}: {os.strerror(error)}")


def load_type_support(name: str) -> None:
    """Import a module of message or service types, and load their compiled support, and the middleware's for messages.

    What can't be loaded is left out: it fails in the same way when it is used.
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
