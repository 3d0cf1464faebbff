"""Keeps what a student's program prints: the beginning and the end of it, however much it is."""

from __future__ import annotations

from dataclasses import dataclass

HEAD_BYTES = 64 * 1024
TAIL_BYTES = 64 * 1024


@dataclass(frozen=True)
class Output:
    """What a program printed on standard output and error, in the order in which it came.

    Attributes:
        data: the bytes kept: all, or the first and the last 64 KiB.
        dropped: how many bytes between the two were not kept.
    """

    data: bytes
    dropped: int

    @property
    def text(self) -> str:
        """The output as text, with a line that tells how much is missing where it is missing."""
        if not self.dropped:
            return self.data.decode(errors="replace")
        head, tail = self.data[:HEAD_BYTES], self.data[HEAD_BYTES:]
        gap = f"\n[... {self.dropped} bytes of output are not shown ...]\n"
        return head.decode(errors="replace") + gap + tail.decode(errors="replace")


class OutputBuffer:
    """Takes pieces of output as they come and holds at most 128 KiB of them."""

    def __init__(self) -> None:
        self._head = bytearray()
        self._tail = bytearray()
        self.total = 0
        """All bytes that came."""

    def add(self, piece: bytes) -> None:
        """Appends a piece."""
        self.total += len(piece)
        room = HEAD_BYTES - len(self._head)
        self._head += piece[:room]
        self._tail += piece[room:]
        del self._tail[:-TAIL_BYTES]

    def output(self) -> Output:
        """What has been kept until now."""
        data = bytes(self._head + self._tail)
        return Output(data, self.total - len(data))
