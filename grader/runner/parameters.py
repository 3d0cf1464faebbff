"""Calls of the parameter services of the student's nodes."""

from __future__ import annotations

from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import GetParameters, SetParameters
from rclpy.serialization import serialize_message

from grader.runner.graph import deaf_to_the_clock
from rmw_lockstep.hub import SERVER, Hub, HubNode


class Parameters:
    """Calls made through one of the hub's nodes."""

    def __init__(self, hub: Hub, node: HubNode) -> None:
        self._hub, self._node = hub, node

    def call(self, service: str, type_name: str, request: bytes, until: int) -> bool:
        """Call a service, and let time pass up to `until` for the answer (ns). Return whether one arrived."""
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
        """Make every node take its time from /clock that doesn't yet. Return whether all do then."""
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
