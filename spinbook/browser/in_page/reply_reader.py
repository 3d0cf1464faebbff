"""Replaces spinbook/kernel/reply_reader.py in a page, for the recorder of timelines.

The page sends every response to the recorder as well, so this reader needs nothing from the middleware.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from typing import Any

from rcl_python import cdr, participant
from rcl_python.link import Frame


class PageReplyReader:
    """Reads the responses of one service; `response` is their class."""

    def __init__(self, node: Any, service: str, response: Any) -> None:
        self._service, self._response = service, response
        self._received: deque[tuple[float, bytes]] = deque()
        participant.current().overhearing.append(self._receive)

    def _receive(self, frame: Frame, data: bytes) -> None:
        server = participant.current().graph.endpoints.get(frame["from"])
        if server is not None and server.topic == self._service:
            self._received.append((frame["sent"] / 1e9, data))

    def take(self) -> Iterator[tuple[float, Any]]:
        """Yield the responses since the last call, each with the time when it was sent (s since the epoch)."""
        while self._received:
            sent, data = self._received.popleft()
            yield sent, cdr.deserialize(data, self._response)


#: The name by which the recorder imports it.
ServiceReplyReader = PageReplyReader
