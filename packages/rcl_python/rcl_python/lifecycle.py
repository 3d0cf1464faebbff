"""The state machine of lifecycle nodes, as rcl_lifecycle's default one (https://design.ros2.org/articles/node_lifecycle.html)."""

from __future__ import annotations

from typing import TypeAlias

from rcl_python import participant
from rcl_python.endpoints import Publisher, Service
from rcl_python.handle import Destroyable
from rcl_python.node import Node
from rcl_python.qos import Profile
from rcl_python.values import RCLError

Transition: TypeAlias = "tuple[int, str, int, str, int, str]"
"""A transition's id and label, its start state, its goal state."""

_STATES = {
    0: "unknown", 1: "unconfigured", 2: "inactive", 3: "active", 4: "finalized", 10: "configuring", 11: "cleaningup",
    12: "shuttingdown", 13: "activating", 14: "deactivating", 15: "errorprocessing",
}  # fmt: skip

#: What a node can be asked to do: (id, label, from, over).
_ASKED = [
    (1, "configure", 1, 10), (2, "cleanup", 2, 11), (3, "activate", 2, 13), (4, "deactivate", 3, 14),
    (5, "shutdown", 1, 12), (6, "shutdown", 2, 12), (7, "shutdown", 3, 12),
]  # fmt: skip
#: Where it goes from there, by how its callback ended: (over, first id, success, failure, error).
_ENDED = [
    (10, 10, 2, 1, 15), (11, 20, 1, 2, 15), (13, 30, 3, 2, 15), (14, 40, 2, 3, 15), (12, 50, 4, 4, 15),
    (15, 60, 1, 4, 4),
]  # fmt: skip


def _transition(number: int, label: str, start: int, goal: int) -> Transition:
    return number, label, start, _STATES[start], goal, _STATES[goal]


def _graph() -> list[Transition]:
    """Return every transition, in rcl_lifecycle's order: each followed by its ends."""
    found: list[Transition] = []
    ends = {over: (first, goals) for over, first, *goals in _ENDED}
    for number, label, start, over in _ASKED:
        found.append(_transition(number, label, start, over))
        if over != 12 or number == 7:
            found += _ends(over, *ends[over])
    return found + _ends(15, *ends[15])


def _ends(over: int, first: int, goals: list[int]) -> list[Transition]:
    labels = ("transition_success", "transition_failure", "transition_error")
    return [_transition(first + n, label, over, goals[n]) for n, label in enumerate(labels)]


def _service(name: str) -> property:
    """Return a property: the state machine's service of this name; None without `enable_com_interface`."""
    return property(lambda machine: machine._services.get(name))


class LifecycleStateMachine(Destroyable):
    """The states of one node, and, with `enable_com_interface`, the services that change and show them."""

    def __init__(self, node: Node, enable_com_interface: bool) -> None:
        if not isinstance(enable_com_interface, bool):
            raise TypeError(f"enable_com_interface has to be a bool, not {enable_com_interface!r}")
        super().__init__()
        self._state = 1
        self._services: dict[str, Service] = {}
        self._publisher: Publisher | None = None
        if enable_com_interface:
            self._open(node)

    def _open(self, node: Node) -> None:
        from lifecycle_msgs.msg import TransitionEvent
        from lifecycle_msgs.srv import ChangeState, GetAvailableStates, GetAvailableTransitions, GetState

        self._publisher = Publisher(node, TransitionEvent, "~/transition_event", Profile())
        kinds = {
            "change_state": ChangeState,
            "get_state": GetState,
            "get_available_states": GetAvailableStates,
            "get_available_transitions": GetAvailableTransitions,
            "get_transition_graph": GetAvailableTransitions,
        }
        self._services = {name: Service(node, kind, f"~/{name}", Profile()) for name, kind in kinds.items()}

    def _destroy(self) -> None:
        for end in (*self._services.values(), self._publisher):
            if end is not None:
                end.destroy_when_not_in_use()

    @property
    def initialized(self) -> bool:
        """Whether it can be used."""
        return not self._destroyed

    @property
    def current_state(self) -> tuple[int, str]:
        """The id and the label of the state."""
        return self._state, _STATES[self._state]

    @property
    def available_states(self) -> list[tuple[int, str]]:
        """Every state."""
        return list(_STATES.items())

    @property
    def transition_graph(self) -> list[Transition]:
        """Every transition."""
        return _graph()

    @property
    def available_transitions(self) -> list[Transition]:
        """The transitions from the state."""
        return [item for item in self.transition_graph if item[2] == self._state]

    def get_transition_by_label(self, label: str) -> int:
        """Return the id of the transition with this label from the state. Raises RCLError if there is none."""
        for item in self.available_transitions:
            if item[1] == label:
                return item[0]
        raise RCLError("Failed to get transition from label: error not set")

    def trigger_transition_by_id(self, number: int, publish_update: bool) -> None:
        """Take a transition. Raises RCLError if the state has none with this id."""
        self._take([item for item in self.available_transitions if item[0] == number], publish_update)

    def trigger_transition_by_label(self, label: str, publish_update: bool) -> None:
        """Take a transition. Raises RCLError if the state has none with this label."""
        self._take([item for item in self.available_transitions if item[1] == label], publish_update)

    def _take(self, found: list[Transition], publish_update: bool) -> None:
        if not found:
            reason = f"no transition matches from {_STATES[self._state]}"
            raise RCLError(f"Failed to trigger lifecycle state machine transition: {reason}")
        self._state = found[0][4]
        if publish_update and self._publisher is not None:
            self._publish(found[0])

    def _publish(self, taken: Transition) -> None:
        from lifecycle_msgs.msg import State, Transition, TransitionEvent

        number, label, start, start_label, goal, goal_label = taken
        event = TransitionEvent(
            timestamp=participant.current().link.system(),
            transition=Transition(id=number, label=label),
            start_state=State(id=start, label=start_label),
            goal_state=State(id=goal, label=goal_label),
        )
        if self._publisher is not None:
            self._publisher.publish(event)

    service_change_state = _service("change_state")
    service_get_state = _service("get_state")
    service_get_available_states = _service("get_available_states")
    service_get_available_transitions = _service("get_available_transitions")
    service_get_transition_graph = _service("get_transition_graph")
