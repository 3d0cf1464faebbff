"""Threads in a page: they take turns in the one thread of a web worker, each on a stack of its own.

A thread that waits, for a lock, a message or the time, lets the others run: it awaits a promise on its own stack
(JavaScript Promise Integration, JSPI). Nothing else interrupts it, so a thread that computes without a pause keeps the
others waiting. This module replaces the primitives of `threading`: locks, and the start and the identity of threads.
Everything built on these (Condition, Event, Semaphore, queues, ThreadPoolExecutor) is Python's own.
"""

from __future__ import annotations

import _thread
import _threading_local
import itertools
import queue
import sys
import threading
import time
from collections.abc import Callable, Iterable
from types import TracebackType
from typing import Any, Protocol

from spinbook.browser.in_page import garbage

_numbers = itertools.count(1_000)
_main = threading.get_ident()
_current = _main
_page: Any = None
_await: Callable[[Any], None]
_deliver_signals: Callable[[], None]
_waiting = 0


class ThreadScheduler(Protocol):
    """Schedules the threads of a program that is being checked (scheduler.py)."""

    def schedules(self, thread: int) -> bool: ...
    def pause(self, milliseconds: float) -> None: ...
    def changed(self) -> None: ...
    def start(self, run: Callable[[], None]) -> int: ...


_scheduler: ThreadScheduler | None = None


def use_scheduler(scheduler: ThreadScheduler | None) -> None:
    """Use this scheduler from now on; None for no scheduler."""
    global _scheduler
    _scheduler = scheduler


def get_ident() -> int:
    """Return the number of the thread whose turn it is."""
    return _current if _page else _thread.get_ident()


def pause(milliseconds: float, for_frames: bool) -> None:
    """Let other threads run for this long (-1: no limit), or until something changes or a frame arrives."""
    if _scheduler and _scheduler.schedules(get_ident()):
        _scheduler.pause(milliseconds)
    elif _page:
        _pause_in_page(milliseconds, for_frames)
    else:
        raise RuntimeError("a thread waits that no scheduler manages")


def _pause_in_page(milliseconds: float, for_frames: bool) -> None:
    global _current, _waiting
    mine = _current
    garbage.before_suspending()
    _waiting += 1
    try:
        _await(_page.wait(milliseconds, for_frames))
    finally:
        _waiting -= 1
        _current = mine
        garbage.after_resuming(_waiting)
    if mine == _main:
        _deliver_signals()


def changed() -> None:
    """Let all waiting threads check again."""
    if _scheduler:
        _scheduler.changed()
    if _waiting:
        _page.wake()


class Lock:
    """The replacement of `threading.Lock`."""

    def __init__(self) -> None:
        self._held = False
        self._wanted = 0

    def acquire(self, blocking: bool = True, timeout: float = -1) -> bool:
        """Acquire the lock, waiting for at most `timeout` seconds; return whether it was acquired."""
        until = None if timeout < 0 else time.monotonic() + timeout
        while self._held:
            left = -1.0 if until is None else 1000 * (until - time.monotonic())
            if not blocking or (until is not None and left <= 0):
                return False
            self._wait(left)
        self._held = True
        return True

    def _wait(self, milliseconds: float) -> None:
        self._wanted += 1
        try:
            self._pause(milliseconds)
        finally:
            self._wanted -= 1

    def _pause(self, milliseconds: float) -> None:
        pause(milliseconds, False)

    def _wake(self) -> None:
        changed()

    def release(self) -> None:
        """Release the lock. Raises RuntimeError if it is not held."""
        if not self._held:
            raise RuntimeError("release unlocked lock")
        self._held = False
        if self._wanted:
            self._wake()

    def locked(self) -> bool:
        """Return whether it is held."""
        return self._held

    def __enter__(self) -> bool:
        return self.acquire()

    def __exit__(self, kind: type[BaseException] | None, error: object, trace: TracebackType | None) -> None:
        self.release()

    def _at_fork_reinit(self) -> None:
        self._held = False


class _RawLock(Lock):
    """A lock that waits without the scheduler."""

    def _pause(self, milliseconds: float) -> None:
        _pause_in_page(milliseconds, False)

    def _wake(self) -> None:
        _page.wake()


class NotifyingCondition(threading.Condition):
    """A condition that also wakes threads that wait for messages."""

    def notify_all(self) -> None:
        """Let all waiting threads check again."""
        super().notify_all()
        changed()


class Handle:
    """The replacement of what `threading.Thread` holds of a started thread."""

    def __init__(self) -> None:
        self.ident = 0
        self._done = False

    def is_done(self) -> bool:
        """Return whether it has ended."""
        return self._done

    def _set_done(self) -> None:
        self._done = True
        changed()

    def join(self, timeout: float | None = None) -> None:
        """Wait for its end, for at most `timeout` seconds."""
        until = None if timeout is None or timeout < 0 else time.monotonic() + timeout
        while not self._done and (until is None or time.monotonic() < until):
            pause(-1 if until is None else max(0.0, 1000 * (until - time.monotonic())), False)


def raw_lock() -> Any:
    """Return a lock for the scheduler itself: it waits without one."""
    return _RawLock() if _page else _thread.allocate_lock()


def raw_start(run: Callable[[], None]) -> int:
    """Start a thread without a scheduler; return its number."""
    if not _page:
        return _thread.start_new_thread(run, ())
    from pyodide.ffi import create_proxy  # type: ignore[import-not-found]

    number = next(_numbers)

    def run_as_thread() -> None:
        global _current
        _current = number
        run()

    _page.spawn(create_proxy(run_as_thread))
    return number


def _begin(run: Callable[[], None]) -> int:
    if _scheduler and _scheduler.schedules(get_ident()):
        return _scheduler.start(run)
    return raw_start(run)


def _start(function: Callable[[], None], handle: Handle | None = None, daemon: bool = True) -> Handle:
    """Start a thread: called by `threading` (Python 3.13 and newer)."""
    started = handle or Handle()

    def run() -> None:
        try:
            function()
        finally:
            started._set_done()

    started.ident = _begin(run)
    return started


_sentinels: dict[int, Lock] = {}


def _set_sentinel() -> Lock:
    """Return a lock that is released when this thread has ended: called by `threading` (Python 3.12 and older)."""
    return _sentinels.setdefault(get_ident(), Lock())


def _start_new(function: Callable[..., None], args: tuple[Any, ...]) -> int:
    """Start a thread: called by `threading` (Python 3.12 and older)."""

    def run() -> None:
        try:
            function(*args)
        finally:
            sentinel = _sentinels.pop(get_ident(), None)
            if sentinel and sentinel.locked():
                sentinel.release()

    return _begin(run)


def use(page: Any, deliver_signals: Callable[[], None]) -> None:
    """Let threads wait in this page. After each wait, `deliver_signals` is called in the main thread."""
    global _page, _await, _deliver_signals
    from pyodide.ffi import run_sync

    _page, _await, _deliver_signals = page, run_sync, deliver_signals


def replace_threading() -> None:
    """Make `threading` and everything built on it use these threads, which wait in a page or in a scheduler.

    Call this before anything is imported that keeps a lock.
    """
    patched: dict[str, Any] = {
        "Lock": Lock,
        "_allocate_lock": Lock,
        "RLock": threading._RLock,
        "get_ident": get_ident,
        "get_native_id": get_ident,
        "_start_joinable_thread": _start,
        "_ThreadHandle": Handle,
        "_start_new_thread": _start_new,
        "_set_sentinel": _set_sentinel,
        "local": _threading_local.local,
    }
    for name, value in patched.items():
        if hasattr(threading, name):
            setattr(threading, name, value)
    # The version in C has its own way of waiting.
    queue.SimpleQueue = queue._PySimpleQueue  # type: ignore[misc, attr-defined]


def wait_for_all() -> None:
    """Wait for the threads that keep a program from ending, as Python does after a program's last line."""
    for call in reversed(threading._threading_atexits):  # type: ignore[attr-defined]
        call()
    for thread in threading.enumerate():
        if thread is not threading.main_thread() and not thread.daemon:
            thread.join()


def forget(started: Iterable[int]) -> None:
    """Make `threading` and its pools forget these threads, so that another program can run."""
    for number in started:
        threading._active.pop(number, None)  # type: ignore[attr-defined]
    getattr(threading, "_shutdown_locks", set()).clear()
    pools = sys.modules.get("concurrent.futures.thread")
    if pools is not None:
        vars(pools)["_shutdown"] = False
        vars(pools)["_threads_queues"].clear()
