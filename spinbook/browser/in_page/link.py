"""Connects a process in a web worker to the others, through the page, which is the hub.

Waiting is a promise that is awaited on the program's own stack (see threads.py): the program blocks in `rclpy.spin`
while the worker's event loop continues.
"""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Iterator
from typing import Any, SupportsFloat

from rcl_python import participant
from rcl_python.link import Frame, LocalLink
from spinbook.browser.in_page import threads

#: A program that never waits lets the page run after this time (s).
_YIELD_AFTER_S = 0.02


class PageLink(LocalLink):
    """The link of one worker. `page` is the worker's JavaScript side (worker.js)."""

    def __init__(self, page: Any) -> None:
        from pyodide.ffi import to_js  # type: ignore[import-not-found]

        self.lock = threads.NotifyingCondition(threading.RLock())
        self._page, self._to_js = page, to_js
        self._yielded = time.monotonic()

    def send(self, frame: Frame, data: bytes = b"") -> None:
        """Send a frame to the page."""
        self._page.send(json.dumps(frame), self._to_js(data) if data else None)

    def receive(self) -> Iterator[tuple[Frame, bytes]]:
        """Yield the frames that the page has forwarded."""
        while (item := self._page.receive()) is not None:
            yield json.loads(item.head), item.data.to_bytes() if item.data else b""

    def wait(self, nanoseconds: int | None) -> None:
        """Wait for a frame, for another thread, or until the time is up."""
        held = self.lock._release_save()  # type: ignore[attr-defined]
        try:
            self._pause(nanoseconds)
        finally:
            self.lock._acquire_restore(held)  # type: ignore[attr-defined]

    def _pause(self, nanoseconds: int | None) -> None:
        self._yielded = time.monotonic()
        threads.pause(-1 if nanoseconds is None else nanoseconds / 1e6, True)

    def breathe(self, looks: bool, news: bool) -> int:
        """Let the page run, so that frames arrive, if the program has not waited for a while."""
        if time.monotonic() - self._yielded > _YIELD_AFTER_S:
            self.wait(0)
        return 0

    def sleep(self, seconds: SupportsFloat) -> None:
        """Sleep as time.sleep does; a signal whose handler raises ends it."""
        until = time.monotonic() + float(seconds)
        while (left := until - time.monotonic()) > 0:
            self._pause(int(left * 1e9))
            participant.current().pump()

    def deliver_signals(self) -> None:
        """Handle the signals that have arrived."""
        while (name := self._page.signal()) is not None:
            participant.current().on_signal(name)
