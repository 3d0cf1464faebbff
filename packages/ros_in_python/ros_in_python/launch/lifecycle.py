"""Nodes with a life cycle in a launch: their transitions in a row, and a node of the launch's own that asks for them.

States and transitions: https://design.ros2.org/articles/node_lifecycle.html
"""

from __future__ import annotations

import queue
import threading
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

from ros_in_python.launch import events
from ros_in_python.ros2.cli import CommandError

if TYPE_CHECKING:
    from ros_in_python.launch.actions import LifecycleNode

#: Numbers of transitions in lifecycle_msgs/msg/Transition.
CONFIGURE, ACTIVATE = 1, 3
#: The state in which a node is after each transition.
_GOALS = {CONFIGURE: "inactive", 2: "unconfigured", ACTIVATE: "active", 4: "inactive"}
_GOALS |= dict.fromkeys((5, 6, 7), "finalized")
#: How often the thread checks for requests (s).
_POLL_S = 0.05


def transitions(names: Sequence[str], numbers: Sequence[int]) -> Iterator[Any]:
    """Yield the actions that make nodes do transitions, each when the one before has led to its state.

    Raises `CommandError` for a number that is no transition.
    """
    if unknown := [number for number in numbers if number not in _GOALS]:
        raise CommandError(f"{unknown[0]} is not a transition: {', '.join(map(str, _GOALS))}")
    for name in names:
        matcher = events.matches_node_name(name)
        emissions = [
            events.EmitEvent(events.ChangeState(lifecycle_node_matcher=matcher, transition_id=number))
            for number in numbers
        ]
        for number, emission in zip(numbers, emissions[1:], strict=False):
            yield events.RegisterEventHandler(
                events.OnStateTransition(
                    target_lifecycle_node=matcher, goal_state=_GOALS[number], entities=[emission], handle_once=True
                )
            )
        yield from emissions[:1]


class LifecycleClient:
    """Asks nodes for transitions, and reports the changes of their state, from a thread of its own."""

    def __init__(self, report: Callable[[events.StateTransition | str], None]) -> None:
        self._report = report
        self._requests: queue.Queue[Callable[[Any], None]] = queue.Queue()
        self._is_over = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def watch(self, action: LifecycleNode) -> None:
        """Report each change of this node's state from now on."""
        self._requests.put(lambda graph: self._subscribe(graph, action))

    def change(self, action: LifecycleNode, transition: int) -> None:
        """Ask a node for a transition, as soon as it answers. A refusal is reported as a text."""
        self._requests.put(lambda graph: self._change(graph, action.node_name, transition))

    def close(self) -> None:
        """End the thread."""
        self._is_over.set()
        self._thread.join()

    def _run(self) -> None:
        from ros_in_python.ros2.opening import open_graph

        try:
            with open_graph() as graph:
                while not self._is_over.is_set():
                    graph.spin_until(lambda: not self._requests.empty() or self._is_over.is_set(), _POLL_S)
                    while not self._requests.empty() and not self._is_over.is_set():
                        self._requests.get()(graph)
        except CommandError as error:
            self._report(error.message)

    def _subscribe(self, graph: Any, action: LifecycleNode) -> None:
        from lifecycle_msgs.msg import TransitionEvent

        def changed(message: Any) -> None:
            start, goal = message.start_state.label, message.goal_state.label
            self._report(events.StateTransition(action, message.transition.label, start, goal))

        graph.node.create_subscription(TransitionEvent, f"{action.node_name}/transition_event", changed, 10)

    def _change(self, graph: Any, name: str, number: int) -> None:
        from lifecycle_msgs.msg import Transition

        from ros_in_python.ros2.lifecycle import call

        if not graph.spin_until(lambda: self._is_over.is_set() or self._answers(graph, name)) or self._is_over.is_set():
            return
        try:
            succeeded = call(graph, name, "ChangeState", "change_state", transition=Transition(id=number)).success
        except CommandError as error:
            self._report(error.message)
            return
        if not succeeded:
            self._report(f"{name} did not make transition {number}: its callback failed, or its state has no such one")

    def _answers(self, graph: Any, name: str) -> bool:
        return any(service.name == f"{name}/change_state" for service in graph.services())
