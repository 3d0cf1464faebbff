"""What the node needs of the message types in use, be they turtlesim's own or stand-ins."""

from __future__ import annotations

from typing import Protocol

from spinbook.turtlesim.events import Event


class Interface(Protocol):
    """The topics, services and actions of the turtles."""

    #: What the log says at the start about types that are not turtlesim's own; empty where they are.
    statement: str

    def add(self, turtle: str) -> None:
        """Open everything that belongs to a turtle."""

    def remove(self, turtle: str) -> None:
        """Close everything that belongs to a turtle."""

    def publish(self, event: Event) -> None:
        """Send what has happened to whoever listens."""
