"""The graph is looked at when it is known: what has started was heard of, and what has ended has left."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import pytest
import rclpy

from ros_in_python.ros2 import graph
from ros_in_python.ros2.domain import participants
from spinbook.graph import watcher
from spinbook.graph.watcher import GraphWatcher

#: So many questions for the participants take far longer than the graph has to rest to be taken for known.
LATE = 60


@dataclass
class OneLess:
    """Counts the participants of this host as if one had ended, until `late` has been called at the 60th question."""

    late: Callable[[], None] | None = None
    asked: int = 0

    def __call__(self, domain: int) -> int | None:
        self.asked += 1
        if self.late and self.asked == LATE:
            self.late()
        count = participants(domain)
        return count - 1 if count and not (self.late and self.asked >= LATE) else count

    def take_over(self, monkeypatch: pytest.MonkeyPatch) -> None:
        """Answer whoever asks from now on."""
        for module in (watcher, graph):
            monkeypatch.setattr(module, "participants", self)


@contextlib.contextmanager
def node_that_leaves() -> Iterator[Callable[[], None]]:
    """A node in a context of its own, with what ends it."""
    context = rclpy.Context()
    rclpy.init(context=context)
    node = rclpy.create_node("leaver", context=context)

    def leave() -> None:
        if context.ok():
            node.destroy_node()
            rclpy.shutdown(context=context)

    try:
        yield leave
    finally:
        leave()


@pytest.mark.usefixtures("ros_domain")
def test_a_node_that_has_ended_is_gone_even_if_that_arrives_late(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(watcher, "_DEADLINE_S", 60.0)
    with node_that_leaves() as leave, GraphWatcher() as watching:
        watching.wait_until_idle()
        assert [one.name for one in watching.graph().nodes] == ["/leaver"]
        OneLess(leave).take_over(monkeypatch)
        watching.wait_until_idle()
        assert watching.graph().nodes == ()


@pytest.mark.usefixtures("ros_domain")
def test_a_node_that_was_killed_is_waited_for_only_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(watcher, "_DEADLINE_S", 0.5)
    with node_that_leaves(), GraphWatcher() as watching:
        watching.wait_until_idle()
        killed = OneLess()
        killed.take_over(monkeypatch)
        watching.wait_until_idle()
        first, killed.asked = killed.asked, 0
        watching.wait_until_idle()
        assert killed.asked < 10 < first
