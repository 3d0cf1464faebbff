"""Sends goals to the student's action server, and records the raw status, the feedback and every response."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, TypeAlias

from action_msgs.msg import GoalStatusArray
from action_msgs.srv import CancelGoal as CancelService
from rclpy.serialization import serialize_message

from grader.recording.events import STATES, Cancel, Feedback, Goal, GoalState
from grader.runner.cdr import deserialized
from grader.runner.grader_side import ACCEPT_ANY, GraderSide
from grader.runner.message import filled, message_class, to_fields
from grader.scenario.scenario import CancelAll, CancelGoal, Scenario, SendGoal
from rmw_lockstep.hub import HubClient, HubSubscription
from rmw_lockstep.hub.endpoints import Moment

CancelStep: TypeAlias = CancelGoal | CancelAll

CANCEL, STATUS = "action_msgs/srv/CancelGoal", "action_msgs/msg/GoalStatusArray"


@dataclass
class SentGoal:
    """A goal that was sent, and the numbers of its requests."""

    step: SendGoal
    number: int
    request: int | None
    accepted: bool | None = None
    result: int | None = None
    cancels: list[tuple[int, int | None]] = field(default_factory=list)

    @property
    def id(self) -> bytes:
        """The goal's UUID: its number."""
        return self.number.to_bytes(16, "big")


class ScriptedActionClient:
    """The grader's end of one of the student's actions."""

    def __init__(self, ends: GraderSide, action: str, type_name: str) -> None:
        self._ends, self.action, self.type = ends, action, type_name
        self._kind = message_class(type_name)
        node, base = ends.node, f"{action}/_action"
        self._send: HubClient = node.client(f"{base}/send_goal", f"{type_name}_SendGoal")
        self._cancel: HubClient = node.client(f"{base}/cancel_goal", CANCEL)
        self._result: HubClient = node.client(f"{base}/get_result", f"{type_name}_GetResult")
        self._feedback: HubSubscription = node.subscription(
            f"{base}/feedback", f"{type_name}_FeedbackMessage", ACCEPT_ANY
        )
        self._status: HubSubscription = node.subscription(f"{base}/status", STATUS, ACCEPT_ANY)
        self._goals: list[SentGoal] = []

    def send(self, step: SendGoal, number: int) -> None:
        """Send a goal."""
        request = self._kind.Impl.SendGoalService.Request()
        request.goal_id.uuid = list(number.to_bytes(16, "big"))
        filled(request.goal, step.fields)
        self._goals.append(SentGoal(step, number, self._send.call(serialize_message(request))))

    def cancel(self, at: int, number: int) -> None:
        """Request to cancel goal `number`, or every goal for 0."""
        request = CancelService.Request()
        request.goal_info.goal_id.uuid = list(number.to_bytes(16, "big"))
        made = self._cancel.call(serialize_message(request))
        for goal in self._goals:
            if number in (0, goal.number):
                goal.cancels.append((at, made))

    def react(self, now: int) -> bool:
        """Request the results of newly accepted goals. Return whether there were any."""
        asked = False
        for goal in self._goals:
            if goal.accepted is None and goal.request is not None and goal.request in self._send.answers:
                response = deserialized(self._send.answers[goal.request], self._kind.Impl.SendGoalService.Response)
                goal.accepted = bool(response.accepted)
                if goal.accepted:
                    request = self._kind.Impl.GetResultService.Request()
                    request.goal_id.uuid = list(goal.id)
                    goal.result = self._result.call(serialize_message(request))
                    asked = True
        return asked

    # --- outcomes

    def goals(self) -> list[Goal]:
        """Return everything about each goal."""
        states, feedback = self._states(), self._feedbacks()
        return [self._goal(goal, states.get(goal.id, ()), feedback.get(goal.id, ())) for goal in self._goals]

    def _goal(self, sent: SentGoal, states: tuple[GoalState, ...], feedback: tuple[Feedback, ...]) -> Goal:
        status, result = self._result_of(sent)
        step = sent.step
        return Goal(
            number=sent.number,
            at_ns=step.at,
            action=self.action,
            type=self.type,
            goal=step.fields,
            by="grader",
            accepted=sent.accepted,
            answered_ns=self._when(self._send, sent.request),
            states=states,
            feedback=feedback,
            cancels=tuple(self._cancelled(sent, at, number) for at, number in sent.cancels),
            status=status,
            result=result,
            finished_ns=self._when(self._result, sent.result),
        )

    def _when(self, client: HubClient, number: int | None) -> int | None:
        moment: Moment | None = None if number is None else client.moments.get(number)
        return None if moment is None else self._ends.at(moment)

    def _result_of(self, sent: SentGoal) -> tuple[str, dict[str, Any] | None]:
        cdr = None if sent.result is None else self._result.answers.get(sent.result)
        if cdr is None:
            return "", None
        response = deserialized(cdr, self._kind.Impl.GetResultService.Response)
        return state_name(response.status), to_fields(response.result)

    def _cancelled(self, sent: SentGoal, at: int, number: int | None) -> Cancel:
        cdr = None if number is None else self._cancel.answers.get(number)
        if cdr is None:
            return Cancel(at)
        response = deserialized(cdr, CancelService.Response)
        accepted = any(bytes(info.goal_id.uuid) == sent.id for info in response.goals_canceling)
        return Cancel(at, self._when(self._cancel, number), accepted, int(response.return_code))

    def _states(self) -> dict[bytes, tuple[GoalState, ...]]:
        found: dict[bytes, list[GoalState]] = {}
        for heard in self._status.heard:
            for one in deserialized(heard.cdr, GoalStatusArray).status_list:
                states = found.setdefault(bytes(one.goal_info.goal_id.uuid), [])
                state = state_name(one.status)
                if not states or states[-1].state != state:
                    states.append(GoalState(self._ends.at(heard), state))
        return {goal: tuple(states) for goal, states in found.items()}

    def _feedbacks(self) -> dict[bytes, tuple[Feedback, ...]]:
        found: dict[bytes, list[Feedback]] = {}
        for heard in self._feedback.heard:
            message = deserialized(heard.cdr, self._kind.Impl.FeedbackMessage)
            feedback = Feedback(self._ends.at(heard), to_fields(message.feedback))
            found.setdefault(bytes(message.goal_id.uuid), []).append(feedback)
        return {goal: tuple(messages) for goal, messages in found.items()}


def state_name(number: int) -> str:
    """Return the name of a state of action_msgs/msg/GoalStatus."""
    return STATES[number] if 0 <= number < len(STATES) else "unknown"


class Goals:
    """All goals of a scenario, for all actions."""

    def __init__(self, ends: GraderSide, scenario: Scenario) -> None:
        self._clients: dict[str, ScriptedActionClient] = {}
        self._actions: dict[int, str] = {}
        for step in scenario.steps:
            if isinstance(step, SendGoal) and step.action not in self._clients:
                self._clients[step.action] = ScriptedActionClient(ends, step.action, step.type)

    def send(self, step: SendGoal) -> None:
        """Send the next goal."""
        number = len(self._actions) + 1
        self._actions[number] = step.action
        self._clients[step.action].send(step, number)

    def cancel(self, step: CancelStep) -> None:
        """Request to cancel a goal, or all goals."""
        if isinstance(step, CancelAll):
            self._clients[step.action].cancel(step.at, 0)
        else:
            self._clients[self._actions[step.number]].cancel(step.at, step.number)

    def react(self, now: int) -> bool:
        """Continue with each action's goals. Return whether there was anything to do."""
        went_on = [client.react(now) for client in self._clients.values()]
        return any(went_on)

    def goals(self) -> tuple[Goal, ...]:
        """Return everything about each goal, in the order in which they were sent."""
        return tuple(sorted((one for c in self._clients.values() for one in c.goals()), key=lambda one: one.number))
