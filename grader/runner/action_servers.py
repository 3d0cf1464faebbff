"""Scripted action servers, for the student's action client."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

from action_msgs.msg import GoalInfo, GoalStatus, GoalStatusArray
from action_msgs.srv import CancelGoal as CancelService
from rclpy.serialization import serialize_message

from grader.recording.events import STATES, Cancel, Feedback, Goal, GoalState
from grader.runner.action_clients import CANCEL, STATUS
from grader.runner.cdr import deserialized
from grader.runner.grader_side import GraderSide, Schedule, nanoseconds
from grader.runner.message import filled, message_class, to_fields
from grader.runner.message_order import requests_in_order
from grader.runner.program import CannotContinue
from grader.scenario.scenario import SECOND
from grader.scenario.servers import ActionServer as Declared
from grader.scenario.servers import GoalScript
from rmw_lockstep.hub import HubPublisher, HubServer, PendingRequest, QosPolicies
from rmw_lockstep.qos import TRANSIENT_LOCAL

#: What rcl gives the status topic (rcl_action_qos_profile_status_default).
STATUS_QOS = QosPolicies(depth=1, durability=TRANSIENT_LOCAL)

#: No exercise needs more goals, or more requests to cancel them, from a node in one scenario.
MOST_GOALS = 300

#: The bytes before a request's own fields: the CDR header and the goal's id, which the client chooses at random.
_HEADER_AND_ID = 4 + 16


@dataclass
class RunningGoal:
    """One goal that arrived, as it is recorded so far. `waiting` are the requests for its result."""

    id: bytes
    script: GoalScript
    asked: PendingRequest
    recorded: Goal
    waiting: list[PendingRequest] = field(default_factory=list)

    @property
    def state(self) -> str:
        """The goal's current state."""
        return self.recorded.states[-1].state if self.recorded.states else "unknown"

    def record(self, **changes: Any) -> None:
        """Change these fields of what is recorded."""
        self.recorded = replace(self.recorded, **changes)


class ScriptedActionServer:
    """One of the grader's action servers, which handles each goal as the scenario says."""

    def __init__(self, ends: GraderSide, schedule: Schedule, declared: Declared) -> None:
        self.name = declared.action
        self._ends, self._schedule, self._declared = ends, schedule, declared
        self._kind = message_class(declared.type)
        self._goals: list[RunningGoal] = []
        self._servers: tuple[HubServer, HubServer, HubServer] | None = None
        self._publishers: tuple[HubPublisher, HubPublisher] | None = None
        self._cancels = 0

    def open(self) -> None:
        """Start the server."""
        if self._servers is not None:
            return
        node, base, kind = self._ends.node, f"{self.name}/_action", self._declared.type
        self._servers = (
            node.server(f"{base}/send_goal", f"{kind}_SendGoal"),
            node.server(f"{base}/cancel_goal", CANCEL),
            node.server(f"{base}/get_result", f"{kind}_GetResult"),
        )
        feedback = node.publisher(f"{base}/feedback", f"{kind}_FeedbackMessage", QosPolicies())
        self._publishers = feedback, node.publisher(f"{base}/status", STATUS, STATUS_QOS)

    def close(self) -> None:
        """Stop the server; its goals are left as they are."""
        for end in (*(self._servers or ()), *(self._publishers or ())):
            end.close()
        self._servers = self._publishers = None

    def react(self, now: int) -> bool:
        """Take the requests that arrived, and plan the answers. Return whether there were any."""
        if self._servers is None:
            return False
        found = False
        for server, take in zip(self._servers, (self._goal, self._cancel, self._result), strict=True):
            requests, server.asked[:] = requests_in_order(server.asked, lambda cdr: cdr[_HEADER_AND_ID:]), []
            for one in requests:
                take(one, now)
                found = True
        return found

    def _limit(self, what: str, number: int) -> None:
        """Raise `CannotContinue` if there are too many: each goal is in every later status, and in each cancel."""
        if number >= MOST_GOALS:
            raise CannotContinue("over-limit", f"Your node sent more than {MOST_GOALS} {what} to {self.name}.")

    # --- requests

    def _goal(self, asked: PendingRequest, now: int) -> None:
        self._limit("goals", len(self._goals))
        request = deserialized(asked.cdr, self._kind.Impl.SendGoalService.Request)
        number, at = len(self._goals) + 1, self._ends.at(asked.moment)
        script = self._declared.scripts[min(number, len(self._declared.scripts)) - 1]
        fields = to_fields(request.goal)
        recorded = Goal(number, at, self.name, self._declared.type, fields, "node", node=asked.node)
        goal = RunningGoal(bytes(request.goal_id.uuid), script, asked, recorded)
        self._goals.append(goal)
        self._later(at + nanoseconds(script.answers_after), now, lambda moment: self._answer(goal, moment))

    def _answer(self, goal: RunningGoal, now: int) -> None:
        goal.record(accepted=goal.script.accept, answered_ns=now)
        response = self._kind.Impl.SendGoalService.Response(accepted=goal.script.accept)
        response.stamp.sec, response.stamp.nanosec = divmod(now, SECOND)
        assert self._servers
        self._servers[0].respond(goal.asked, serialize_message(response))
        if not goal.script.accept:
            return
        self._enter(goal, "accepted", now)
        self._enter(goal, "executing", now)
        for after, fields in goal.script.feedback:
            self._plan(goal, now + nanoseconds(after), lambda moment, f=fields: self._feed(goal, f, moment))
        end = goal.script.end
        if end != "never":
            self._plan(goal, now + nanoseconds(goal.script.after), lambda moment: self._end(goal, end, moment))

    def _cancel(self, asked: PendingRequest, now: int) -> None:
        self._limit("requests to cancel", self._cancels)
        self._cancels += 1
        request = deserialized(asked.cdr, CancelService.Request)
        goal_id = bytes(request.goal_info.goal_id.uuid)
        at = self._ends.at(asked.moment)
        goals = [one for one in self._goals if one.recorded.accepted and goal_id in (one.id, bytes(16))]
        running = [one for one in goals if one.state in ("accepted", "executing")]
        taken = [one for one in running if one.script.cancel != "refuse"]
        response = CancelService.Response()
        if not taken:
            ended = CancelService.Response.ERROR_GOAL_TERMINATED
            refused, unknown = CancelService.Response.ERROR_REJECTED, CancelService.Response.ERROR_UNKNOWN_GOAL_ID
            response.return_code = refused if running else ended if goals else unknown
        response.goals_canceling = [_info(one) for one in taken]
        for one in goals:
            cancel = Cancel(at, now, one in taken, int(response.return_code))
            one.record(cancels=(*one.recorded.cancels, cancel))
        assert self._servers
        self._servers[1].respond(asked, serialize_message(response))
        for one in taken:
            self._enter(one, "canceling", now)
            if one.script.cancel == "accept":
                due = now + nanoseconds(one.script.cancel_takes)
                self._plan(one, due, lambda moment, goal=one: self._end(goal, "canceled", moment))

    def _result(self, asked: PendingRequest, now: int) -> None:
        request = deserialized(asked.cdr, self._kind.Impl.GetResultService.Request)
        goal = next((one for one in self._goals if one.id == bytes(request.goal_id.uuid)), None)
        if goal is not None and goal.recorded.asked_result_ns is None:
            goal.record(asked_result_ns=self._ends.at(asked.moment))
        if goal is None or not goal.recorded.accepted:
            self._send_result(asked, 0, {})
            return
        goal.waiting.append(asked)
        self._give_result(goal)

    # --- what happens to a goal

    def _plan(self, goal: RunningGoal, at: int, act: Any) -> None:
        """Plan `act`; it is skipped if the goal has ended or the server is gone by then."""

        def when_due(now: int) -> None:
            if self._servers is not None and goal.recorded.finished_ns is None:
                act(now)

        self._schedule.plan(at, when_due)

    def _later(self, at: int, now: int, act: Any) -> None:
        servers = self._servers

        def when_due(moment: int) -> None:
            if servers is self._servers:
                act(moment)

        self._schedule.plan(max(at, now), when_due)

    def _enter(self, goal: RunningGoal, state: str, now: int) -> None:
        goal.record(states=(*goal.recorded.states, GoalState(now, state)))
        message = GoalStatusArray()
        for one in self._goals:
            if one.recorded.states:
                message.status_list.append(GoalStatus(goal_info=_info(one), status=STATES.index(one.state)))
        assert self._publishers
        self._publishers[1].publish(serialize_message(message))

    def _feed(self, goal: RunningGoal, fields: dict[str, Any], now: int) -> None:
        message = self._kind.Impl.FeedbackMessage()
        message.goal_id.uuid = list(goal.id)
        filled(message.feedback, fields)
        goal.record(feedback=(*goal.recorded.feedback, Feedback(now, to_fields(message.feedback))))
        assert self._publishers
        self._publishers[0].publish(serialize_message(message))

    def _end(self, goal: RunningGoal, state: str, now: int) -> None:
        goal.record(finished_ns=now)
        self._enter(goal, state, now)
        self._give_result(goal)

    def _give_result(self, goal: RunningGoal) -> None:
        if goal.recorded.finished_ns is None:
            return
        for asked in goal.waiting:
            self._send_result(asked, STATES.index(goal.state), goal.script.result)
            goal.record(status=goal.state, result=to_fields(filled(self._kind.Result(), goal.script.result)))
        goal.waiting.clear()

    def _send_result(self, asked: PendingRequest, status: int, fields: dict[str, Any]) -> None:
        response = self._kind.Impl.GetResultService.Response(status=status)
        filled(response.result, fields)
        assert self._servers
        self._servers[2].respond(asked, serialize_message(response))

    def goals(self) -> tuple[Goal, ...]:
        """Return every goal that arrived, with its outcome."""
        return tuple(goal.recorded for goal in self._goals)


def _info(goal: RunningGoal) -> GoalInfo:
    info = GoalInfo()
    info.goal_id.uuid = list(goal.id)
    info.stamp.sec, info.stamp.nanosec = divmod(goal.recorded.answered_ns or goal.recorded.at_ns, SECOND)
    return info
