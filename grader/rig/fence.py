"""Knows when a node has handled everything that was published so far.

A fence is a call of a service that the node's own executor answers. The executor answers in the order in which things
arrive, so an answer means that what was published before the call has been handled. One call can overtake a message
that is still inside the middleware; three after the clock and two after messages never did (see docs/grading.md).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Literal

from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import GetParameters, SetParameters
from type_description_interfaces.srv import GetTypeDescription

from grader.rig.graph import Graph
from grader.rig.patience import Patience
from grader.rig.quiet import Threads
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

SLEEPY = "Your node waits and sleeps instead of answering: {0:g} s in this scenario. Let callbacks return at once."

#: A node may be blocked this long in one scenario, over all messages.
MOST_BLOCKED_S = 20.0


class Gone(Exception):
    """Raised when the student's program has ended by itself."""


class Fence:
    """Holds the rig until the student's nodes have handled what was published.

    `check` is called again and again meanwhile, and may raise what ends the run.
    """

    def __init__(self, ros: Ros, node: Any, student: Student, check: Callable[[], None]) -> None:
        self._ros, self._node, self._student, self._check = ros, node, student, check
        self._calls: list[tuple[Any, Any]] = []
        self._threads = Threads(student.pid)
        self._blocked = 0.0
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
                    # Of a type that does not exist, in the form of a type's hash: else the node logs an error.
                    request = GetTypeDescription.Request(type_name="none", type_hash=f"RIHS01_{64 * '0'}")
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
        self._wait_for(lambda: all(client.service_is_ready() for client, _ in self._calls), 10.0, 0.002)

    def wait(self, times: int) -> None:
        """Wait until the nodes have handled what was published before this call. Raises `Stopped` or `Gone`."""
        for _ in range(times if self._calls else 0):
            self._once()
        self._rest()
        self._ros.turn()

    def _once(self) -> None:
        answers = [client.call_async(request) for client, request in self._calls]
        self._wait_for(lambda: all(answer.done() for answer in answers))

    def _wait_for(self, done: Callable[[], bool], cpu_s: float = 3.0, every_s: float = 0.02) -> None:
        """Handle what arrives until `done`. Raises `Stopped` or `Gone` when it can't be waited for any longer."""
        patience: Patience | None = None

        def meanwhile() -> None:
            nonlocal patience
            self.alive()
            self._check()
            # Most waits are over before this is needed the first time.
            patience = patience or Patience(self._student, cpu_s)
            blocked = patience.blocked
            patience.check(ENDLESS.format(cpu_s), DEAF)
            self._blocked += patience.blocked - blocked
            if self._blocked > MOST_BLOCKED_S:
                raise Stopped("timed-out", SLEEPY.format(MOST_BLOCKED_S))

        self._ros.turn_until(done, meanwhile, every_s)

    def _rest(self) -> None:
        """Wait until none of the program's threads is at work: a node may use threads of its own."""
        self.alive()
        if self.hold == "quiet":
            self._rest_without_answers()
            return
        enough = self._restless >= RESTLESS_TIMES or self._threads.still()
        if not enough and not self._threads.wait_until_still(0.0, RESTLESS_S):
            self._restless += 1

    def _rest_without_answers(self) -> None:
        patience = Patience(self._student)
        while not self._threads.wait_until_still(STILL_S, 0.1):
            self.alive()
            self._ros.turn()
            self._check()
            if patience.ended() == "cpu":
                raise Stopped("timed-out", ENDLESS.format(3.0))

    def close(self) -> None:
        """Let go of the student's program."""
        self._threads.close()

    def call(self, kind: Any, name: str, request: Any) -> Any:
        """Call any service of the node and return its answer."""
        client = self._node.create_client(kind, name)
        try:
            self._wait_for(client.service_is_ready, every_s=0.002)
            answer = client.call_async(request)
            self._wait_for(answer.done)
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
