"""Counts the messages that stay inside the program, which its hub does not see.

In the grader, messages.cpp of rmw_lockstep does this.
"""

from __future__ import annotations

from collections import Counter

from rcl_python.graph import EndpointInfo

#: Report to the hub after this many messages from one endpoint at one moment.
REPORTED = 100

#: Log messages do not count: logging in a loop is harmless.
LOG = "/rosout"


class LocalMessages:
    """Counts messages and requests of the current moment, by the endpoint that sent them."""

    def __init__(self) -> None:
        self._now = 0
        self._sent: Counter[str] = Counter()

    def count(self, sender: EndpointInfo, now: int) -> bool:
        """Count a message sent at the time `now` (ns). Return whether to report `REPORTED` messages of its sender."""
        if sender.topic == LOG:
            return False
        if now != self._now:
            self._now = now
            self._sent.clear()
        self._sent[sender.gid] += 1
        return self._sent[sender.gid] % REPORTED == 0
