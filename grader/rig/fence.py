"""Knows when a node has handled everything that was published so far.

A fence is a call of a service that the node's own executor answers. The executor answers in the order in which things
arrive, so an answer means that what was published before the call has been handled. One call can overtake a message
that is still inside the middleware; three after the clock and two after messages never did (see docs/grading.md).
"""

from __future__ import annotations

from typing import Any, Literal

from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import GetParameters, SetParameters
from type_description_interfaces.srv import GetTypeDescription

from grader.rig.graph import Graph
from grader.rig.patience import Patience
from grader.rig.quiet import activity, wait_for_quiet
from grader.rig.ros import Ros
from grader.rig.stopped import Stopped
from grader.rig.student import Student

Hold = Literal["parameters", "type description", "quiet"]

AFTER_CLOCK = 3
AFTER_MESSAGES = 2

#: A node that gives no hold counts as idle when none of its threads ran for this long.
STILL_S = 0.004

#: A node that never rests is given this long, so often, before the rig relies on its answers alone.
RESTLESS_S, RESTLESS_TIMES = 0.25, 3

ENDLESS = "Your node used {0:g} s of computing time on one message without an end. Is there an endless loop?"
DEAF = (
    "Your node does not answer: it is there, but it does nothing. Does your program call rclpy.spin(node), and does no "
    "callback wait or sleep?"
)


class Gone(Exception):
    """Raised when the student's program has ended by itself."""


class Fence:
    """Holds the rig until the student's nodes have handled what was published."""

    def __init__(self, ros: Ros, node: Any, student: Student) -> None:
        self._ros, self._node, self._student = ros, node, student
        self._calls: list[tuple[Any, Any]] = []
        self._restless = 0
        self.hold: Hold = "quiet"

    def alive(self) -> None:
        """Raise `Gone` when the student's program has ended."""
        if self._student.poll() is not None:
            raise Gone

    def take_hold(self, graph: Graph, nodes: list[str]) -> None:
        """Find a service of each node to call; create these clients last, for their answers prove that all earlier
        end points of the rig are known to the node."""
        patience = Patience(self._student, cpu_s=5.0, blocked_s=0.25)
        found: dict[str, tuple[str, Any, Any]] = {}
        while len(found) < len(nodes):
            for node in nodes:
                services = graph.services(node)
                if f"{node}/get_parameters" in services:
                    found[node] = (f"{node}/get_parameters", GetParameters, GetParameters.Request())
                elif f"{node}/get_type_description" in services and patience.blocked > 0.1:
                    request = GetTypeDescription.Request()
                    found[node] = (f"{node}/get_type_description", GetTypeDescription, request)
            self.alive()
            if patience.ended():
                break
            self._ros.executor.spin_once(timeout_sec=0.005)
        for name, kind, request in found.values():
            self._calls.append((self._node.create_client(kind, name), request))
        if found:
            parameters = all(kind is GetParameters for _, kind, _ in found.values())
            self.hold = "parameters" if parameters else "type description"
        self._wait_until_ready()

    def _wait_until_ready(self) -> None:
        patience = Patience(self._student, cpu_s=10.0)

        def meanwhile() -> None:
            self.alive()
            patience.check(ENDLESS.format(10.0), DEAF)

        self._ros.turn_until(lambda: all(c.service_is_ready() for c, _ in self._calls), meanwhile, 0.002)

    def wait(self, times: int) -> None:
        """Wait until the nodes have handled what was published before this call. Raises `Stopped` or `Gone`."""
        for _ in range(times if self._calls else 0):
            self._once()
        self._rest()
        self._ros.turn()

    def _once(self) -> None:
        patience = Patience(self._student)
        answers = [client.call_async(request) for client, request in self._calls]

        def meanwhile() -> None:
            self.alive()
            patience.check(ENDLESS.format(3.0), DEAF)

        self._ros.turn_until(lambda: all(answer.done() for answer in answers), meanwhile)

    def _rest(self) -> None:
        """Wait until none of the program's threads is at work: a node may use threads of its own."""
        self.alive()
        if self.hold == "quiet":
            self._rest_without_answers()
        elif self._restless < RESTLESS_TIMES:
            before = activity(self._student.pid)
            if before is not None and before == activity(self._student.pid):
                return
            if not wait_for_quiet(self._student.pid, 0.0, RESTLESS_S):
                self._restless += 1

    def _rest_without_answers(self) -> None:
        patience = Patience(self._student)
        while not wait_for_quiet(self._student.pid, STILL_S, 0.1):
            self.alive()
            self._ros.turn()
            if patience.ended() == "cpu":
                raise Stopped("timed-out", ENDLESS.format(3.0))

    def call(self, kind: Any, name: str, request: Any) -> Any:
        """Call any service of the node and return its answer."""
        client = self._node.create_client(kind, name)
        patience = Patience(self._student)

        def meanwhile() -> None:
            self.alive()
            patience.check(ENDLESS.format(3.0), DEAF)

        try:
            self._ros.turn_until(client.service_is_ready, meanwhile, 0.002)
            answer = client.call_async(request)
            self._ros.turn_until(answer.done, meanwhile)
            return answer.result()
        finally:
            self._node.destroy_client(client)

    def use_sim_time(self, node: str) -> bool:
        """Whether `node` takes its time from /clock; where it does not yet, tell it to."""
        asked = GetParameters.Request(names=["use_sim_time"])
        values = self.call(GetParameters, f"{node}/get_parameters", asked).values
        if values and values[0].bool_value:
            return True
        wanted = ParameterValue(type=ParameterType.PARAMETER_BOOL, bool_value=True)
        request = SetParameters.Request(parameters=[Parameter(name="use_sim_time", value=wanted)])
        results = self.call(SetParameters, f"{node}/set_parameters", request).results
        return bool(results) and all(result.successful for result in results)
