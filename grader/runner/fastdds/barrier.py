"""Knows when a node has handled everything that was published so far.

A barrier is a call of a service that the node's own executor answers; then the rest of the program's threads finish.
A published message reaches the node before the call does, and wakes a program that waits for nothing else, so its
executor finds the message first; when all threads are idle after the answer, the message's effects are over, too.

A program that also wakes by itself, by a clock of its own, may check what is ready at the very moment when message
and call arrive, and so find the call first. By the answer to a second call it has checked again, and messages come
before calls; a third lets the timers fire that a new time has made due. They are sent at once: each is answered in a
round of its own.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any, Literal

from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import GetParameters, SetParameters
from type_description_interfaces.srv import GetTypeDescription

from grader.runner.fastdds.graph import Caller, Calls, Graph
from grader.runner.fastdds.idle import IdleTime, TimeBudget, Watch
from grader.runner.student import Stopped

Synchronization = Literal["parameters", "type description", "idle"]

AFTER_CLOCK = 3
AFTER_MESSAGES = 2

#: A node without a synchronization method counts as idle when none of its threads ran for this long.
STILL_S = 0.004

#: A node that is never idle is given this long, this many times, before the runner relies on its answers alone.
RESTLESS_S, RESTLESS_TIMES = 0.25, 3

ENDLESS = "Your node used {0:g} s of computing time on one message and did not finish. Is there an endless loop?"
UNRESPONSIVE = (
    "Your node started but never responds. Does your program call rclpy.spin(node), and does no callback wait or sleep?"
)

SLEEPY = "Your node waits and sleeps instead of answering: {0:g} s in this scenario. Let callbacks return at once."

#: How often to check that the student's program is still running, while waiting for an answer.
CHECK_S = 0.02

#: A call that has had no answer is repeated after this much idle time.
AGAIN_S = 0.5

#: How often to look for changes of the graph.
LOOK_S = 0.002

#: A node may be blocked this long in one scenario, over all messages.
MOST_BLOCKED_S = 20.0


class Gone(Exception):
    """Raised when the student's program has ended by itself."""


class Barrier:
    """Holds the runner until the student's nodes have handled what was published.

    `receive` takes what they publish; it is called repeatedly, and may raise an exception that ends the run.
    """

    def __init__(self, node: Any, watch: Watch, receive: Callable[[], None]) -> None:
        self._node, self._watch, self._receive = node, watch, receive
        self._calls = Calls(node.context, ())
        self._blocked = 0.0
        self._restless = 0
        self._wakes_itself = False
        self.synchronization: Synchronization = "idle"

    def alive(self) -> None:
        """Raise `Gone` when the student's program has ended."""
        if self._watch.student.poll() is not None:
            raise Gone

    def choose_method(self, graph: Graph, nodes: list[str], no_more_to_come: Callable[[], bool]) -> None:
        """Find a service of each node to call; create these clients last, as their answers prove that all earlier end
        points of the runner are known to the node. `no_more_to_come` returns whether the graph must be complete."""
        found: dict[str, tuple[str, Any, Any]] = {}
        while True:
            for node in nodes:
                services = graph.services(node)
                if f"{node}/get_parameters" in services:
                    found[node] = (f"{node}/get_parameters", GetParameters, GetParameters.Request())
                elif f"{node}/get_type_description" in services:  # which every node creates after the other one
                    # Of a type that does not exist, in the form of a type's hash: otherwise the node logs an error.
                    request = GetTypeDescription.Request(type_name="none", type_hash=f"RIHS01_{64 * '0'}")
                    found[node] = (f"{node}/get_type_description", GetTypeDescription, request)
            self.alive()
            if len(found) == len(nodes) or no_more_to_come():
                break
            time.sleep(LOOK_S)
        calls = [(Caller(self._node, kind, name), request) for name, kind, request in found.values()]
        self._calls = Calls(self._node.context, calls)
        if found:
            parameters = all(kind is GetParameters for _, kind, _ in found.values())
            self.synchronization = "parameters" if parameters else "type description"
            self._watch.threads.with_middleware = False
        self._wait_for(self._calls.ready, lambda: time.sleep(LOOK_S), 10.0)

    def look(self) -> None:
        """Check whether the program has done anything since it was idle; to be called before anything is published."""
        self._wakes_itself = self._wakes_itself or self._watch.threads.has_run()

    def wait(self, times: int) -> None:
        """Wait until the nodes have handled what was published before this call. Raises `Stopped` or `Gone`."""
        self._calls.call(times if self._wakes_itself else 1)
        self._wait_for_answers(self._calls)
        self._rest()
        self._watch.receivers.wait()
        self._receive()

    def _wait_for_answers(self, calls: Calls) -> None:
        idle_time = IdleTime(self._watch)

        def pause() -> None:
            calls.wait(CHECK_S)
            if not calls.answered() and idle_time.look() >= AGAIN_S:
                calls.call_again()
                idle_time.seconds = 0.0

        self._wait_for(calls.answered, pause)

    def _wait_for(self, done: Callable[[], bool], pause: Callable[[], None], cpu_s: float = 3.0) -> None:
        """Pause until `done`. Raises `Stopped` or `Gone` when waiting any longer is pointless."""
        budget: TimeBudget | None = None
        due = time.monotonic() + CHECK_S
        while not done():
            pause()
            if time.monotonic() < due:
                continue
            self.alive()
            self._receive()
            # Most waits are over before this is needed.
            budget = budget or TimeBudget(self._watch, cpu_s)
            blocked = budget.blocked
            budget.check(ENDLESS.format(cpu_s), UNRESPONSIVE)
            self._blocked += budget.blocked - blocked
            if self._blocked > MOST_BLOCKED_S:
                raise Stopped("timed-out", SLEEPY.format(MOST_BLOCKED_S))
            due = time.monotonic() + CHECK_S

    def _rest(self) -> None:
        """Wait until none of the program's threads is at work: a node may use threads of its own."""
        self.alive()
        if self.synchronization == "idle":
            self._rest_without_answers()
        elif self._restless < RESTLESS_TIMES and not self._watch.threads.wait_until_idle(0.0, RESTLESS_S):
            self._restless += 1

    def _rest_without_answers(self) -> None:
        budget = TimeBudget(self._watch)
        while not self._watch.threads.wait_until_idle(STILL_S, 0.1):
            self.alive()
            self._receive()
            if budget.ended() == "cpu":
                raise Stopped("timed-out", ENDLESS.format(3.0))

    def call(self, kind: Any, name: str, request: Any) -> Any:
        """Call any service of the node and return its answer."""
        caller = Caller(self._node, kind, name)
        calls = Calls(self._node.context, [(caller, request)])
        try:
            self._wait_for(calls.ready, lambda: time.sleep(LOOK_S), 10.0)
            calls.call(1)
            self._wait_for_answers(calls)
            return caller.answer
        finally:
            caller.close()

    def use_sim_time(self, node: str) -> bool:
        """Return whether `node` takes its time from /clock; if it does not yet, make it do so."""
        asked = GetParameters.Request(names=["use_sim_time"])
        values = self.call(GetParameters, f"{node}/get_parameters", asked).values
        if values and values[0].bool_value:
            return True
        wanted = ParameterValue(type=ParameterType.PARAMETER_BOOL, bool_value=True)
        request = SetParameters.Request(parameters=[Parameter(name="use_sim_time", value=wanted)])
        results = self.call(SetParameters, f"{node}/set_parameters", request).results
        return bool(results) and all(result.successful for result in results)
