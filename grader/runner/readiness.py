"""Waits until a program is ready: it has created its nodes, begins to spin them, and answers calls."""

from __future__ import annotations

from collections.abc import Callable

from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import GetParameters, SetParameters
from rclpy.serialization import serialize_message

from grader.runner.budget import BLOCKED_S, Allowance
from grader.runner.graph import deaf_to_the_clock
from grader.runner.program import CannotContinue
from grader.scenario.scenario import SECOND
from rmw_lockstep.hub import SERVER, Hub, HubNode

#: Importing large libraries takes CPU time, but nothing that a node needs takes this much. A student with an endless
#: loop waits this long for the message.
START_CPU_S = 6.0

#: How long a program may sleep before it creates a node or spins it, by the computer's clock (ns).
LONGEST = 10 * SECOND

#: How long to wait for the subscriptions of a node that spins (ns).
LONGEST_FOR_SUBSCRIPTIONS = 3 * SECOND // 2

NO_NODE_BUSY = f"Your program computed for {START_CPU_S:g} s and created no node. Is there an endless loop before it?"
NOT_SPUN_BUSY = (
    f"Your program created its node, then computed for {START_CPU_S:g} s and did not spin it. Is there an endless loop "
    "before rclpy.spin(node), such as in __init__?"
)
NO_NODE_BLOCKED = (
    "Your program waits and creates no node. Does something wait or sleep before the node is created, and is main() "
    "called?"
)

START = Allowance(NO_NODE_BUSY, NO_NODE_BLOCKED, START_CPU_S, BLOCKED_S)


def wait_until_up(hub: Hub, connected: Callable[[], bool], has_nodes: Callable[[], bool]) -> None:
    """Let the computer's time pass until the program has a node that is ready.

    A node is ready when it has its subscriptions (`connected`), or spins and has had time to create them. `has_nodes`
    returns whether the program has created any. Raises `CannotContinue` if there will be no node.
    """
    try:
        _wait_until_up(hub, connected, has_nodes)
    except CannotContinue as stopped:
        if stopped.message == NO_NODE_BUSY and has_nodes():
            raise CannotContinue(stopped.outcome, NOT_SPUN_BUSY) from None
        raise


def _wait_until_up(hub: Hub, connected: Callable[[], bool], has_nodes: Callable[[], bool]) -> None:
    began = hub.now
    hub.wait_until_idle()
    while not (has_nodes() and connected()):
        wakes = hub.next
        longest = LONGEST_FOR_SUBSCRIPTIONS if has_nodes() and hub.in_ros else LONGEST
        if wakes is None or wakes > began + longest:
            break
        hub.advance(wakes)
        hub.wait_until_idle()
    if not has_nodes():
        raise CannotContinue("did-not-start" if hub.next is None else "timed-out", NO_NODE_BLOCKED)


class Parameters:
    """Calls made through one of the hub's nodes."""

    def __init__(self, hub: Hub, node: HubNode) -> None:
        self._hub, self._node = hub, node

    def call(self, service: str, type_name: str, request: bytes, until: int) -> bool:
        """Call a service, and let time pass until it answers, at most to `until` (ns). Return whether it did."""
        client = self._node.client(service, type_name)
        try:
            if client.call(request) is None:
                return False
            self._hub.wait_until_idle()
            while not client.answers:
                wakes = self._hub.next
                if wakes is None or wakes > until:
                    return False
                self._hub.advance(wakes)
                self._hub.wait_until_idle()
            return True
        finally:
            client.close()

    def use_sim_time(self, until: int) -> bool:
        """Make every node take its time from /clock. Return whether all of them do."""
        value = ParameterValue(type=ParameterType.PARAMETER_BOOL, bool_value=True)
        request = SetParameters.Request(parameters=[Parameter(name="use_sim_time", value=value)])
        for node in deaf_to_the_clock(self._hub):
            service = f"{node}/set_parameters"
            self.call(service, "rcl_interfaces/srv/SetParameters", serialize_message(request), until)
        return not deaf_to_the_clock(self._hub)

    def answers(self, node: str, until: int) -> bool:
        """Return whether a node answers a call; one without parameter services is assumed to."""
        if not self._hub.graph.of_program(f"{node}/get_parameters", SERVER):
            return True
        request = serialize_message(GetParameters.Request(names=["use_sim_time"]))
        return self.call(f"{node}/get_parameters", "rcl_interfaces/srv/GetParameters", request, until)
