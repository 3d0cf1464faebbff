"""Replaces spinbook/kernel/reply_reader.py in a page, for the timeline's recorder.

The page sends every answer to the recorder as well, so nothing of the middleware is needed.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from typing import Any

from rcl_python import cdr, participant
from rcl_python.link import Frame


class PageReplyReader:
    """The answers of one service; `answer` is their class."""

    def __init__(self, node: Any, service: str, answer: Any) -> None:
        self._service, self._answer = service, answer
        self._heard: deque[tuple[float, bytes]] = deque()
        participant.current().overhearing.append(self._hear)

    def _hear(self, frame: Frame, data: bytes) -> None:
        server = participant.current().graph.endpoints.get(frame["from"])
        if server is not None and server.topic == self._service:
            self._heard.append((frame["sent"] / 1e9, data))

    def take(self) -> Iterator[tuple[float, Any]]:
        """Yield what has arrived since the last call: (when it was sent in s since the epoch, the answer)."""
        while self._heard:
            sent, data = self._heard.popleft()
            yield sent, cdr.deserialize(data, self._answer)


#: The name by which the recorder imports it.
ServiceReplyReader = PageReplyReader
