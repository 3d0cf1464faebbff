"""Threads in a page: each runs on a stack of its own in the one thread that a web worker has, and they take turns.

A thread that waits, for a lock, a message or the time, lets the others go on: it awaits a promise on its own stack
(JavaScript Promise Integration, JSPI). Nothing else interrupts it, so a thread that computes without a pause keeps the
others waiting. What `threading` is made of is replaced: locks, and the start and the identity of threads; all that is
built of these (Condition, Event, Semaphore, queues, ThreadPoolExecutor) is Python's own.
"""

from __future__ import annotations

import itertools
import queue
import threading
import time
from collections.abc import Callable
from types import TracebackType
from typing import Any

import _threading_local

_numbers = itertools.count(1_000)
_main = threading.get_ident()
_current = _main
_page: Any = None
_await: Callable[[Any], None]
_spawn: Callable[[Callable[[], None]], None]
_heed: Callable[[], None] = lambda: None
_waiting = 0


def get_ident() -> int:
    """The number of the thread whose turn it is."""
    return _current


def pause(milliseconds: float, for_frames: bool) -> None:
    """Let others go on for so long (-1: without end), or until anything has changed, or a frame has come."""
    global _current, _waiting
    mine = _current
    _waiting += 1
    try:
        _await(_page.wait(milliseconds, for_frames))
    finally:
        _waiting -= 1
        _current = mine
    if mine == _main:
        _heed()


def changed() -> None:
    """Let all who wait look again."""
    if _waiting:
        _page.wake()


class Lock:
    """What `threading.Lock` makes."""

    def __init__(self) -> None:
        self._held = False

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        """Take it, waiting for it for at most `timeout` seconds; whether it was taken."""
        until = None if timeout < 0 else time.monotonic() + timeout
        while self._held:
            left = -1.0 if until is None else 1000 * (until - time.monotonic())
            if not blocking or (until is not None and left <= 0):
                return False
            pause(left, False)
        self._held = True
        return True

    def release(self) -> None:
        """Give it back. Raises RuntimeError where nobody holds it."""
        if not self._held:
            raise RuntimeError("release unlocked lock")
        self._held = False
        changed()

    def locked(self) -> bool:
        """Whether somebody holds it."""
        return self._held

    def __enter__(self) -> bool:
        return self.acquire()

    def __exit__(self, kind: type[BaseException] | None, error: object, trace: TracebackType | None) -> None:
        self.release()

    def _at_fork_reinit(self) -> None:
        self._held = False


class Handle:
    """What `threading.Thread` holds of a thread that has been started."""

    def __init__(self) -> None:
        self.ident = 0
        self._done = False

    def is_done(self) -> bool:
        """Whether it has ended."""
        return self._done

    def _set_done(self) -> None:
        self._done = True
        changed()

    def join(self, timeout: float | None = None) -> None:
        """Wait for its end, for at most `timeout` seconds."""
        until = None if timeout is None or timeout < 0 else time.monotonic() + timeout
        while not self._done and (until is None or time.monotonic() < until):
            pause(-1 if until is None else max(0.0, 1000 * (until - time.monotonic())), False)


def _start(function: Callable[[], None], handle: Handle | None = None, daemon: bool = True) -> Handle:
    """What `threading` calls to start a thread."""
    started = handle or Handle()
    started.ident = next(_numbers)

    def run() -> None:
        global _current
        _current = started.ident
        try:
            function()
        finally:
            started._set_done()

    _spawn(run)
    return started


def use(page: Any, heed: Callable[[], None]) -> None:
    """Replace Python's threads. `heed` is called in the main thread after each wait: it handles signals.

    To be called before anything is imported that keeps a lock.
    """
    global _page, _await, _spawn, _heed
    from pyodide.ffi import create_proxy, run_sync  # type: ignore[import-not-found]

    _page, _await, _heed = page, run_sync, heed
    _spawn = lambda run: page.spawn(create_proxy(run))  # noqa: E731
    patched: dict[str, Any] = {
        "Lock": Lock,
        "_allocate_lock": Lock,
        "RLock": threading._RLock,  # type: ignore[attr-defined]
        "get_ident": get_ident,
        "get_native_id": get_ident,
        "_start_joinable_thread": _start,
        "_ThreadHandle": Handle,
        "local": _threading_local.local,
    }
    for name, value in patched.items():
        setattr(threading, name, value)
    # The one in C waits in a way of its own.
    queue.SimpleQueue = queue._PySimpleQueue  # type: ignore[misc, attr-defined]


def wait_for_all() -> None:
    """Wait for the threads that keep a program from ending, as Python does behind a program's last line."""
    for call in reversed(threading._threading_atexits):  # type: ignore[attr-defined]
        call()
    threading._threading_atexits.clear()  # type: ignore[attr-defined]
    for thread in threading.enumerate():
        if thread is not threading.main_thread() and not thread.daemon:
            thread.join()
