"""Contexts: between `rclpy.init` and `rclpy.shutdown`; and the signals that end them."""

from __future__ import annotations

import os
import signal
import sys
import threading
import weakref
from collections.abc import Sequence
from typing import Any

from rcl_python import logs, participant
from rcl_python.arguments import Arguments, parse
from rcl_python.handle import Destroyable
from rcl_python.values import RCL_DEFAULT_DOMAIN_ID, RCLError, RCLInvalidROSArgsError, SignalHandlerOptions, at

_contexts: weakref.WeakSet[Context] = weakref.WeakSet()


class Context(Destroyable):
    """What the nodes of one `init` share: arguments, a domain, and whether they may continue."""

    def __init__(self, args: Sequence[str], domain_id: int) -> None:
        self._valid = False
        super().__init__()
        for arg in args:
            arg.encode()  # raises UnicodeEncodeError for what is not Unicode
        try:
            self.arguments: Arguments = parse(args)
        except RCLInvalidROSArgsError as error:
            reason = str(error).removeprefix("Failed to parse ROS arguments: ")
            raise RCLError(f"failed to initialize rcl: {reason}") from None
        self.arguments.refuse_unknown()
        self.domain = _domain(domain_id)
        self._valid = True
        _contexts.add(self)
        participant.current().on_signal = interrupt
        participant.current().join()

    def ok(self) -> bool:
        """Whether nodes may go on."""
        return self._valid

    def require_valid(self, what: str, place: str) -> None:
        """Raise RCLError unless nodes may go on."""
        if not self._valid:
            reason = "the given context is not valid, either rcl_init() was not called or rcl_shutdown() was called."
            raise RCLError(f"{what}: {at(reason, place)}")

    def shutdown(self) -> None:
        """End it. Raises RCLError if that has already happened."""
        if not self._valid:
            reason = at("rcl_shutdown already called on the given context", "rcl/init.c:333")
            raise RCLError(f"failed to shutdown: {reason}")
        self.invalidate()

    def invalidate(self) -> None:
        """End every wait in this context."""
        self._valid = False
        _contexts.discard(self)
        wake()

    def get_domain_id(self) -> int:
        """Return the ROS domain."""
        return self.domain

    def _destroy(self) -> None:
        self._valid = False


def _domain(domain: int) -> int:
    if domain != RCL_DEFAULT_DOMAIN_ID:
        return int(domain)
    text = os.environ.get("ROS_DOMAIN_ID", "")
    try:
        return int(text) if text else 0
    except ValueError:
        raise RCLError(f"failed to initialize rcl: ROS_DOMAIN_ID is not an integral number: {text!r}") from None


def wake() -> None:
    """Let every wait check again."""
    lock = participant.current().link.lock
    with lock:
        lock.notify_all()


def configure_logging(context: Context) -> None:
    """Take the log levels from a context's arguments."""
    if context.arguments.level is not None:
        logs.set_level("", context.arguments.level)
    for name, level in context.arguments.levels.items():
        logs.set_level(name, level)


class GuardCondition(Destroyable):
    """Something that a program sets to end a wait."""

    def __init__(self, context: Context) -> None:
        self._destroyed = True
        context.require_valid("failed to create guard_condition", "rcl/guard_condition.c:67")
        super().__init__()
        self.context = context
        self.triggered = False

    def trigger_guard_condition(self) -> None:
        """Set it."""
        self.triggered = True
        wake()

    def is_ready(self) -> bool:
        """Return whether it has been set since the last wait that it ended."""
        return self.triggered

    def taken(self) -> None:
        """Reset it after it has ended a wait."""
        self.triggered = False


_interruptible: list[GuardCondition] = []
_installed = SignalHandlerOptions.NO
_before: dict[int, Any] = {}


def register_sigint_guard_condition(guard: GuardCondition) -> None:
    """Set this guard condition when a signal arrives."""
    _interruptible.append(guard)


def unregister_sigint_guard_condition(guard: GuardCondition) -> None:
    """Forget this guard condition."""
    if guard in _interruptible:
        _interruptible.remove(guard)


def end_all() -> None:
    """Shut down every context and end every wait."""
    for context in list(_contexts):
        context.invalidate()
    for guard in list(_interruptible):
        guard.trigger_guard_condition()


def interrupt(name: str) -> None:
    """Handle a signal from the hub as Python's main thread does: SIGINT raises KeyboardInterrupt."""
    number = getattr(signal, name)
    if _installed in (SignalHandlerOptions.ALL, getattr(SignalHandlerOptions, name)):
        end_all()
    elif name == "SIGTERM" and signal.getsignal(number) is signal.SIG_DFL:
        raise SystemExit(128 + number)
    handler = signal.getsignal(number)
    if callable(handler):
        handler(number, None)


def install_signal_handlers(options: SignalHandlerOptions) -> None:
    """Handle these signals: shut everything down first, then call the earlier handler."""
    global _installed
    _installed = SignalHandlerOptions(options)
    if threading.current_thread() is not threading.main_thread() or sys.platform == "emscripten":
        return
    for name in ("SIGINT", "SIGTERM"):
        number = getattr(signal, name)
        if _installed in (SignalHandlerOptions.ALL, getattr(SignalHandlerOptions, name)) and number not in _before:
            _before[number] = signal.signal(number, _handle)


def uninstall_signal_handlers() -> None:
    """Restore the earlier signal handlers."""
    global _installed
    _installed = SignalHandlerOptions.NO
    if threading.current_thread() is threading.main_thread():
        while _before:
            number, handler = _before.popitem()
            signal.signal(number, handler)


def get_current_signal_handlers_options() -> SignalHandlerOptions:
    """Return the signals that are handled."""
    return _installed


def _handle(number: int, frame: Any) -> None:
    end_all()
    before = _before.get(number)
    if callable(before):
        before(number, frame)
