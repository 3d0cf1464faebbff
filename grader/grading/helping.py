"""At the end of a class: whoever has no submission left to grade helps with the spins of the others' submissions."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Iterator

from grader.grading.spins import Spins


class Helping:
    """Where help is offered and found. Any thread may call anything here."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._under_way: list[Spins] = []
        self._closed = False

    @contextlib.contextmanager
    def wanted(self, spins: Spins) -> Iterator[None]:
        """For as long as this lasts, others may help with these spins."""
        with self._changed:
            self._under_way.append(spins)
            self._changed.notify_all()
        try:
            yield
        finally:
            with self._changed:
                self._under_way.remove(spins)

    def help(self, core: int | None) -> None:
        """Help where the most spins wait, with the program on CPU `core`; returns once this is closed."""
        while self._help_with_one(core):
            pass

    def _help_with_one(self, core: int | None) -> bool:
        spins = self._neediest()
        if spins:
            spins.work(core)
        return spins is not None

    def _neediest(self) -> Spins | None:
        with self._changed:
            self._changed.wait_for(lambda: self._closed or any(spins.left for spins in self._under_way))
            return None if self._closed else max(self._under_way, key=lambda spins: spins.left)

    def close(self) -> None:
        """Nobody has to help any more."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()
