"""Actions: three services and two topics under one name, and the states of goals.

The names and rules are those of rcl_action and https://design.ros2.org/articles/actions.html.
"""

from __future__ import annotations

from functools import partialmethod
from typing import Any, Generic, TypeVar

from rcl_python.clock import Clock, Timer
from rcl_python.endpoints import Client, Publisher, Service, Subscription
from rcl_python.handle import Destroyable
from rcl_python.node import Node
from rcl_python.qos import Profile
from rcl_python.values import GoalEvent, RCLError, rmw_request_id_t
from rcl_python.wait_set import WaitSet

ACCEPTED, EXECUTING, CANCELING, SUCCEEDED, CANCELED, ABORTED = 1, 2, 3, 4, 5, 6
_ACTIVE = (ACCEPTED, EXECUTING, CANCELING)

#: State and event -> the next state.
_NEXT = {
    (ACCEPTED, GoalEvent.EXECUTE): EXECUTING,
    (ACCEPTED, GoalEvent.CANCEL_GOAL): CANCELING,
    (EXECUTING, GoalEvent.CANCEL_GOAL): CANCELING,
    (EXECUTING, GoalEvent.SUCCEED): SUCCEEDED,
    (EXECUTING, GoalEvent.ABORT): ABORTED,
    (CANCELING, GoalEvent.SUCCEED): SUCCEEDED,
    (CANCELING, GoalEvent.ABORT): ABORTED,
    (CANCELING, GoalEvent.CANCELED): CANCELED,
}
_UNKNOWN_GOAL, _GOAL_TERMINATED = 2, 3


def _parts(name: str, side: str) -> dict[str, str]:
    if not name:
        raise ValueError(f"Failed to create action {side} due to invalid topic name '': action name must not be empty")
    parts = ("send_goal", "cancel_goal", "get_result", "feedback", "status")
    return {part: f"{name}/_action/{part}" for part in parts}


_Call = TypeVar("_Call", Client, Service)
_Topic = TypeVar("_Topic", Subscription, Publisher)


class _Action(Destroyable, Generic[_Call, _Topic]):
    """What a server and a client have in common. `profiles` are for goal, result, cancel, feedback and status."""

    def _create(
        self, side: str, call: type[_Call], topic: type[_Topic], node: Node, kinds: Any, name: str,
        profiles: tuple[Profile, ...],
    ) -> None:  # fmt: skip
        self._destroyed = True
        names = _parts(name, side)
        goal, result, cancel, feedback, status = profiles
        try:
            self.goal: _Call = call(node, kinds.SendGoalService, names["send_goal"], goal)
        except ValueError as error:
            raise ValueError(f"Failed to create action {side} due to invalid topic name '{name}' : {error}") from None
        self.cancel: _Call = call(node, kinds.CancelGoalService, names["cancel_goal"], cancel)
        self.result: _Call = call(node, kinds.GetResultService, names["get_result"], result)
        self.feedback: _Topic = topic(node, kinds.FeedbackMessage, names["feedback"], feedback)
        self.status: _Topic = topic(node, kinds.GoalStatusMessage, names["status"], status)
        self._ends: tuple[Any, ...] = (self.goal, self.cancel, self.result, self.feedback, self.status)

    def _destroy(self) -> None:
        for end in self._ends:
            end.destroy_when_not_in_use()

    def is_ready(self, wait_set: WaitSet) -> tuple[bool, ...]:
        """Return which of its parts the last wait found ready."""
        return tuple(wait_set.found_ready(end) for end in self._waited())

    def _waited(self) -> tuple[Any, ...]:
        raise NotImplementedError


class ActionClient(_Action[Client, Subscription]):
    """The client end of an action: it sends goals."""

    def __init__(self, node: Node, action_class: Any, name: str, *profiles: Profile) -> None:
        self._create("client", Client, Subscription, node, action_class.Impl, name, profiles)
        super().__init__()

    def _waited(self) -> tuple[Any, ...]:
        return self.feedback, self.status, self.goal, self.cancel, self.result

    def get_num_entities(self) -> tuple[int, int, int, int, int]:
        """Return subscriptions, guard conditions, timers, clients, services."""
        return 2, 0, 0, 3, 0

    def add_to_waitset(self, wait_set: WaitSet) -> None:
        """Wait for every part."""
        for subscription in (self.feedback, self.status):
            wait_set.add_subscription(subscription)
        for client in (self.goal, self.cancel, self.result):
            wait_set.add_client(client)

    def is_action_server_available(self) -> bool:
        """Return whether there is a complete server."""
        services = all(client.service_server_is_available() for client in (self.goal, self.cancel, self.result))
        return bool(services and all(topic.get_publisher_count() for topic in (self.feedback, self.status)))

    def _send(self, part: str, request: Any) -> int:
        """Send a goal, a request to cancel goals, or a request for a result; return the request's number."""
        client: Client = getattr(self, part)
        return client.send_request(request)

    send_goal_request = partialmethod(_send, "goal")
    send_cancel_request = partialmethod(_send, "cancel")
    send_result_request = partialmethod(_send, "result")

    def _take_response(self, part: str, response_class: Any) -> tuple[int | None, Any]:
        """Return the number of a request and its response, or (None, None)."""
        client: Client = getattr(self, part)
        header, response = client.take_response(response_class)
        return (header.request_id.sequence_number if header else None), response

    take_goal_response = partialmethod(_take_response, "goal")
    take_cancel_response = partialmethod(_take_response, "cancel")
    take_result_response = partialmethod(_take_response, "result")

    def _take_message(self, part: str, message_class: Any) -> Any:
        """Return feedback, or the states of the server's goals; None if nothing has arrived."""
        subscription: Subscription = getattr(self, part)
        taken = subscription.take_message(message_class, False)
        return taken[0] if taken else None

    take_feedback = partialmethod(_take_message, "feedback")
    take_status = partialmethod(_take_message, "status")


class ActionServer(_Action[Service, Publisher]):
    """The server end of an action. The last of `settings`, after the profiles, is how long a result is kept (s);
    negative means for ever."""

    def __init__(self, node: Node, clock: Clock, action_class: Any, name: str, *settings: Any) -> None:
        *profiles, result_timeout = settings
        self._create("server", Service, Publisher, node, action_class.Impl, name, tuple(profiles))
        self.expiry = Timer(clock, node.context, 0, autostart=False)
        self._ends += (self.expiry,)
        self._clock, self._kinds = clock, action_class.Impl
        self._timeout = int(result_timeout * 10**9)
        self.goals: list[ActionGoalHandle] = []
        super().__init__()

    def _waited(self) -> tuple[Any, ...]:
        return self.goal, self.cancel, self.result, self.expiry

    def get_num_entities(self) -> tuple[int, int, int, int, int]:
        """Return subscriptions, guard conditions, timers, clients, services."""
        return 0, 0, 1, 0, 3

    def add_to_waitset(self, wait_set: WaitSet) -> None:
        """Wait for every part."""
        for service in (self.goal, self.cancel, self.result):
            wait_set.add_service(service)
        wait_set.add_timer(self.expiry)

    def _take_request(self, part: str, request_class: Any) -> tuple[rmw_request_id_t | None, Any]:
        """Return a request's header and the request, or (None, None)."""
        service: Service = getattr(self, part)
        request, header = service.service_take_request(request_class)
        return (header.request_id if header else None), request

    take_goal_request = partialmethod(_take_request, "goal")
    take_cancel_request = partialmethod(_take_request, "cancel")
    take_result_request = partialmethod(_take_request, "result")

    def _send_response(self, part: str, header: rmw_request_id_t, response: Any) -> None:
        """Say whether a goal is accepted or which goals are being canceled, or send a goal's result."""
        service: Service = getattr(self, part)
        service.service_send_response(response, header)

    send_goal_response = partialmethod(_send_response, "goal")
    send_cancel_response = partialmethod(_send_response, "cancel")
    send_result_response = partialmethod(_send_response, "result")

    def publish_feedback(self, message: Any) -> None:
        """Publish feedback."""
        self.feedback.publish(message)

    def publish_status(self) -> None:
        """Publish the state of every goal."""
        from action_msgs.msg import GoalStatus

        states = [GoalStatus(goal_info=goal.info, status=goal.state) for goal in self.goals]
        self.status.publish(self._kinds.GoalStatusMessage(status_list=states))

    def goal_exists(self, info: Any) -> bool:
        """Return whether the goal is known."""
        return self._find(info) is not None

    def _find(self, info: Any) -> ActionGoalHandle | None:
        identity = bytes(info.goal_id.uuid)
        return next((goal for goal in self.goals if goal.identity == identity), None)

    def accept(self, goal: ActionGoalHandle) -> None:
        """Keep track of a goal. Raises RCLError if it is already known."""
        if self.goal_exists(goal.info):
            raise RCLError("Failed to accept new goal: goal ID already exists")
        self.goals.append(goal)

    def notify_goal_done(self) -> None:
        """Let results expire in time."""
        ends = [goal.ended + self._timeout for goal in self.goals if goal.ended is not None]
        if ends and self._timeout >= 0:
            self.expiry.expire_at(min(ends))
        else:
            self.expiry.cancel_timer()

    def expire_goals(self, most: int) -> tuple[Any, ...]:
        """Forget at most this many goals whose results have been kept long enough; return their GoalInfo."""
        now = self._clock.now()
        old = [goal for goal in self.goals if goal.ended is not None and now - goal.ended >= self._timeout >= 0]
        for goal in old[:most]:
            self.goals.remove(goal)
        self.notify_goal_done()
        return tuple(goal.info for goal in old[:most])

    def process_cancel_request(self, request: Any, response_class: Any) -> Any:
        """Return the goals that a request means: one, those accepted up to a time, or all."""
        identity, stamp = bytes(request.goal_info.goal_id.uuid), _nanoseconds(request.goal_info.stamp)
        response = response_class()
        if any(identity) and not stamp:
            goal = self._find(request.goal_info)
            chosen = [goal] if goal and goal.is_cancelable() else []
            if not chosen:
                response.return_code = _GOAL_TERMINATED if goal else _UNKNOWN_GOAL
        else:
            every = not any(identity) and not stamp
            cancelable = [goal for goal in self.goals if goal.is_cancelable()]
            chosen = [g for g in cancelable if every or _nanoseconds(g.info.stamp) <= stamp or g.identity == identity]
        response.goals_canceling = [goal.info for goal in chosen]
        return response


def _nanoseconds(stamp: Any) -> int:
    return int(stamp.sec) * 10**9 + int(stamp.nanosec)


class ActionGoalHandle(Destroyable):
    """A goal that a server has accepted."""

    def __init__(self, server: ActionServer, info: Any) -> None:
        super().__init__()
        self.info = info
        self.identity = bytes(info.goal_id.uuid)
        self.state = ACCEPTED
        self.ended: int | None = None
        """When it reached a final state (ns of the server's clock)."""
        self._clock = server._clock
        server.accept(self)

    def get_status(self) -> int:
        """Return the state, as in action_msgs/msg/GoalStatus."""
        return self.state

    def is_active(self) -> bool:
        """Return whether it has not ended."""
        return self.state in _ACTIVE

    def is_cancelable(self) -> bool:
        """Return whether it can still be canceled."""
        return (self.state, GoalEvent.CANCEL_GOAL) in _NEXT

    def update_goal_state(self, event: GoalEvent) -> None:
        """Go to the next state. Raises RCLError if there is none."""
        following = _NEXT.get((self.state, GoalEvent(int(event))))
        if following is None:
            reason = "goal_handle attempted invalid transition from state"
            raise RCLError(f"Failed to update goal state: {reason} {_WORDS[self.state]} with event {event.name}")
        self.state = following
        if not self.is_active():
            self.ended = self._clock.now()


_WORDS = {1: "ACCEPTED", 2: "EXECUTING", 3: "CANCELING", 4: "SUCCEEDED", 5: "CANCELED", 6: "ABORTED"}
