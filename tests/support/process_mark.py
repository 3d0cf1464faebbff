"""Finds the processes that a test started, wherever they have gone."""

from __future__ import annotations

import os
import time
import uuid

import psutil
import pytest


class ProcessMark:
    """Distinguishes the processes of one test from all others, by a variable in their environment."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self._value = uuid.uuid4().hex
        monkeypatch.setenv("SPINBOOK_TEST_MARK", self._value)

    def alive(self) -> list[str]:
        """Return the command lines of those that run."""
        found = []
        for process in psutil.process_iter():
            try:
                is_ours = process.environ().get("SPINBOOK_TEST_MARK") == self._value
                if is_ours and process.pid != os.getpid() and process.status() != psutil.STATUS_ZOMBIE:
                    found.append(" ".join(process.cmdline()))
            except psutil.Error:
                continue
        return found

    def wait_until_none(self, timeout_s: float = 60) -> None:
        """Wait until none runs any more; fail the test if one stays."""
        deadline = time.monotonic() + timeout_s
        while left := self.alive():
            assert time.monotonic() < deadline, f"left behind: {left}"
            time.sleep(0.05)
