"""The objects that rclpy holds, which are destroyed when they are no longer used."""

from __future__ import annotations

import itertools
import sys
from types import TracebackType

from rcl_python.values import InvalidHandle

_pointers = itertools.count(0x10000, 16)


class Destroyable:
    """An object that `destroy_when_not_in_use` ends once the last `with` around it is left."""

    pointer: int = 0
    """The name by which wait sets refer to it."""

    def __init__(self) -> None:
        self.pointer = next(_pointers)
        self._uses = 0
        self._asked = False
        self._destroyed = False

    def __enter__(self) -> None:
        if self._asked:
            raise InvalidHandle("cannot use Destroyable because destruction was requested")
        self._uses += 1

    def __exit__(self, kind: type[BaseException] | None, error: object, trace: TracebackType | None) -> None:
        if not self._uses:
            raise RuntimeError("Internal error: Destroyable use_count would be negative")
        self._uses -= 1
        if self._asked and not self._uses:
            self._end()

    def destroy_when_not_in_use(self) -> None:
        """Destroy the object as soon as it is not in use."""
        if self._asked:
            return
        self._asked = True
        if not self._uses:
            self._end()

    def _end(self) -> None:
        if not self._destroyed:
            self._destroyed = True
            self._destroy()

    def _destroy(self) -> None:
        """Release what the object holds."""

    def __del__(self) -> None:
        if not getattr(self, "_destroyed", True) and not sys.is_finalizing():
            self._end()
