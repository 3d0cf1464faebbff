"""Helpers for actions: what the student's server does with goals, and which goals the student's client sends.

They judge the raw status and feedback topics and the responses, never an ActionClient's callbacks.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from grader.checking.cause import UNKNOWN, Cause
from grader.checking.comparator import TOLERANCE, shown
from grader.checking.graph import lacking, shown_names, topics
from grader.checking.hint_texts import hints
from grader.checking.partial import each
from grader.checking.recorded_run import RecordedRun
from grader.recording.events import By, Cancel, Feedback, Goal

#: rclpy's log line for a goal whose execute callback returned without a state.
_NO_STATE = "Goal state not set, assuming aborted"
#: And for a goal callback that returned something else.
_NO_GOAL_RESPONSE = "Goal request callback did not return a GoalResponse type"

_ENDS = hints("goal_ends")
_FORGOT = Cause("Your execute callback returned without goal_handle.succeed(), so rclpy aborted the goal.", *_ENDS)
_NOT_EXECUTED = Cause(
    "Your node accepted the goal and never executed it: a handle_accepted_callback has to call goal_handle.execute().",
    *_ENDS,
)
_NO_RESPONSE = Cause(
    "Your goal callback has to return GoalResponse.ACCEPT or GoalResponse.REJECT, each way through it.",
    *hints("goal_response"),
)
_GAVE_UP = Cause("Your execute callback called goal_handle.abort(), which is for a goal that it gives up.", *_ENDS)

_CANCEL = hints("cancel")
_DISREGARDED = Cause("Your node accepted the request to cancel, and then called succeed() anyway.", *_CANCEL)
_REFUSED = Cause(
    "Your node rejected the request to cancel: without a cancel callback, a server rejects every cancel request.",
    *_CANCEL,
)
_WENT_ON = Cause(
    "Your node accepted the request to cancel, but continued: execute must check goal_handle.is_cancel_requested.",
    *_CANCEL,
)
_NO_ANSWER = Cause("Your node never answered the request to cancel: execute blocks the executor.", *_CANCEL)
_OVER = Cause("The goal had ended before the request to cancel arrived.", *hints("ended_before"))
_TOO_LATE = Cause(
    "Your node answered the request to cancel only after the goal had ended: execute blocks the executor.", *_CANCEL
)
_NEVER = Cause("The goal never ended.", *hints("never_ends"))
_STUCK = Cause(
    "The goal never ended. Your node did nothing more while it executed the goal. Does execute wait for the node's "
    "clock, with one thread? That thread then reads no clock: run the node in a MultiThreadedExecutor.",
    *hints("one_thread"),
)
_NO_FEEDBACK = Cause("Your node never publishes feedback.", *hints("no_feedback"))


def goals(run: RecordedRun, action: str = "", by: By = "grader") -> tuple[Goal, ...]:
    """Return the scenario's goals for the student's server, in order; with `by="node"`, those of the student's
    client.

    Example: `run.goals("/count")[0].status`
    """
    name = run.existing("action", action or run.only("action" if by == "grader" else "action_client"))
    return tuple(goal for goal in run.recording.goals if goal.action == name and goal.by == by)


def scenario_goal(run: RecordedRun, number: int) -> Goal:
    """Return the scenario's goal with this number. Raises ValueError if it sends no such goal.

    Example: `run.goal(1).feedback[0].fields["sequence"]`
    """
    for goal in run.recording.goals:
        if goal.number == number and goal.by == "grader":
            return goal
    raise ValueError(f"there is no goal {number}: the scenario {run.scenario} sends fewer.")


def must_accept(run: RecordedRun, goal: int = 1) -> None:
    """Check that the node accepts this goal.

    Example: `run.must_accept(1)`
    """
    _must_answer(run, scenario_goal(run, goal), accepted=True)


def must_reject(run: RecordedRun, goal: int = 1) -> None:
    """Check that the node rejects this goal.

    Example: `run.must_reject(2)`
    """
    _must_answer(run, scenario_goal(run, goal), accepted=False)


def must_go_through(run: RecordedRun, *states: str, goal: int = 1) -> None:
    """Check that the goal goes through exactly these states, such as "accepted", "executing", "succeeded".

    The default is the states of the solution's goal.

    Example: `run.must_go_through("accepted", "executing", "succeeded", goal=1)`
    """
    student = scenario_goal(run, goal)
    expected = states or tuple(state.state for state in _solutions(run, goal).states)
    got = tuple(state.state for state in student.states)
    _must_answer(run, student, accepted=True) if expected else None
    if got != expected:
        at = next((s.at for s, w in zip(student.states, expected, strict=False) if s.state != w), student.at)
        text = f"expected the states {' → '.join(expected)}, got {' → '.join(got) or 'none'}."
        run.wrong_at(at, text, _part(student), " → ".join(expected), " → ".join(got), _why(run, student, expected[-1]))


def must_end(run: RecordedRun, status: str, goal: int = 1, within: float | None = None) -> None:
    """Check that the goal ends as "succeeded", "canceled" or "aborted", within this many seconds after it was sent.

    Example: `run.must_end("succeeded", goal=1, within=2.5)`
    """
    student = scenario_goal(run, goal)
    _must_answer(run, student, accepted=True)
    ended = _ended_at(student) or student.at
    if (got := _ended_as(student)) != status:
        text = f"it was expected to end as {status}, got {got}."
        run.wrong_at(ended, text, _part(student), status, got, _why(run, student, status))
    late = ended - student.at
    if within is not None and late > within + 1e-9:
        text = f"it was expected to end within {within:g} s, got {late:.2f} s."
        run.wrong_at(ended, text, _part(student), f"{within:g} s", f"{late:.2f} s")


def must_cancel(run: RecordedRun, goal: int = 1, within: float = 1.0) -> None:
    """Check that the node accepts the scenario's first request to cancel this goal, and ends the goal as "canceled".

    Both must happen within this many seconds of simulated time, and the node must send no feedback after that.

    Example: `run.must_cancel(3, within=0.5)`
    """
    student = scenario_goal(run, goal)
    _must_answer(run, student, accepted=True)
    if not student.cancels:
        raise ValueError(f"the scenario {run.scenario} never asks to cancel goal {goal}.")
    cancel = student.cancels[0]
    if (got := _ended_as(student)) != "canceled":
        text = f"after the request to cancel it was expected to end as canceled, got {got}."
        run.wrong_at(cancel.at, text, _part(student), "canceled", got, _why(run, student, "canceled"))
    ended = _ended_at(student) or cancel.at
    late = ended - cancel.at
    if late > within + 1e-9:
        text = f"it was expected to end within {within:g} s of the request to cancel, got {late:.2f} s."
        run.wrong_at(cancel.at, text, _part(student), f"{within:g} s", f"{late:.2f} s")
    if after := [feedback for feedback in student.feedback if feedback.at > ended]:
        text = "no feedback was expected after the goal was canceled, but your node continues to send it."
        run.wrong_at(after[0].at, text, _part(student), "no feedback", f"{len(after)} messages")


def must_match_results(run: RecordedRun, field: str = "", action: str = "", tolerance: float = TOLERANCE) -> None:
    """Check that each goal's result has the same `field` as with the solution. By default every field counts.

    Example: `run.must_match_results("sequence")`
    """

    def result(goal: Goal) -> dict[str, Any] | None:
        return goal.result

    for student, reference in _match(run, action, "grader", field, tolerance, result, "result"):
        if reference.finished is not None and student.finished is None:
            _must_answer(run, student, accepted=True)
            run.wrong_at(student.at, "a result was expected, got none.", _part(student), "a result", "none", _NEVER)


def must_match_feedback(
    run: RecordedRun, field: str = "", goal: int = 1, tolerance: float = TOLERANCE, time: float | None = None
) -> None:
    """Check that the goal's feedback matches the solution's, message by message.

    With `time`, each message must also come within this many seconds of the solution's.

    Example: `run.must_match_feedback("sequence", goal=1, time=0.05)`
    """
    student, reference = scenario_goal(run, goal), _solutions(run, goal)
    _must_answer(run, student, accepted=True)
    pairs = list(zip(reference.feedback, student.feedback, strict=False))
    messages = [(expected.fields, got.fields) for expected, got in pairs]
    expected_count, count = len(reference.feedback), len(student.feedback)

    def judge(numbered: tuple[int, tuple[Feedback | None, Feedback | None]]) -> None:
        number, (expected, got) = numbered
        if expected is None or got is None:
            text = f"expected {expected_count} feedback messages, got {count}."
            stuck = _ended_at(student) is None and _does_nothing_after(run, student)
            never = UNKNOWN if count else _STUCK if stuck else _NO_FEEDBACK
            run.wrong_at(student.at, text, _part(student), f"{expected_count} messages", count, never)
        part = f"{_part(student)}, feedback {number}"
        run.compare_at(got.at, part, field, got.fields, expected.fields, tolerance, student.action, messages)
        run.time_at(got.at, expected.at, part, time, since=student.at)

    each(enumerate(itertools.zip_longest(reference.feedback, student.feedback), start=1), judge)


def must_match_goals(
    run: RecordedRun, field: str = "", action: str = "", tolerance: float = TOLERANCE, time: float | None = None
) -> None:
    """Check that the node, a client, sends as many goals as the solution, with the same `field`.

    With `time`, each must be sent within this many seconds of the solution's.

    Example: `run.must_match_goals("order", "/climb", time=0.1)`
    """
    name = action or run.only("action_client")
    got, expected = len(goals(run, name, by="node")), len(_reference_goals(run, name, "node"))
    if got != expected:
        lacks = not got and name not in topics(run, "action client")
        never = replace(lacking("action client"), seen=f"Your node has no action client for {name}.")
        text = f"expected {expected} goals for {name}, got {got}."
        run.wrong_at(None, text, "", f"{expected} goals", got, never if lacks else run.waits())

    def sent(goal: Goal) -> dict[str, Any] | None:
        return goal.goal

    for student, reference in _match(run, name, "node", field, tolerance, sent, "goal"):
        run.time_at(student.at, reference.at, _part(student), time)


def must_ask_only_for_accepted(run: RecordedRun, action: str = "") -> None:
    """Check that the node, a client, does not ask for the result of a goal that was rejected.

    Example: `run.must_ask_only_for_accepted("/climb")`
    """
    if not _reference_goals(run, action or run.only("action_client"), "node"):
        raise ValueError(f"in the scenario {run.scenario} the solution sends no goal: there is nothing to look at.")
    for student in goals(run, action, by="node"):
        if student.accepted is False and student.asked_result is not None:
            text = "it was rejected, but your node asked for its result. Check goal_handle.accepted."
            run.wrong_at(student.asked_result, text, _part(student), "no request for the result", "one")


def _match(
    run: RecordedRun,
    action: str,
    by: By,
    field: str,
    tolerance: float,
    part_of: Callable[[Goal], dict[str, Any] | None],
    what: str,
) -> list[tuple[Goal, Goal]]:
    name = action or run.only("action" if by == "grader" else "action_client")
    references = _reference_goals(run, name, by)
    both = list(zip(goals(run, name, by), references, strict=False))
    if by == "grader" and not references:
        raise ValueError(f"the scenario {run.scenario} sends no goal for {name}. Add at(0.5).send_goal({name!r}, …).")
    pairs = [(e, g) for student, reference in both if (g := part_of(student)) and (e := part_of(reference))]
    for student, reference in both:
        expected, got = part_of(reference), part_of(student)
        if expected is not None and got is not None:
            at = student.at if what == "goal" else student.finished
            part = f"{_part(student)}, its {what}"
            run.compare_at(at, part, field, got, expected, tolerance, name, pairs)
    return both


def _must_answer(run: RecordedRun, goal: Goal, accepted: bool) -> None:
    expected = "accepted" if accepted else "rejected"
    if goal.accepted is None:
        if goal.action not in topics(run, "action server"):
            names = shown_names(run, "action server")
            text = f"your node has no action {goal.action}. Its actions are: {names}."
            run.wrong_at(goal.at, text, "", goal.action, names, lacking("action server"))
        text = "your node never said whether it accepts the goal. Does a callback block it?"
        run.wrong_at(goal.at, text, _part(goal), expected, "no answer")
    if goal.accepted != accepted:
        got = "accepted" if goal.accepted else "rejected"
        none = _NO_RESPONSE if _NO_GOAL_RESPONSE in run.recording.log else UNKNOWN
        run.wrong_at(goal.at, f"it must be {expected}, but your node {got} it.", _part(goal), expected, got, none)


def _why(run: RecordedRun, goal: Goal, expected: str) -> Cause:
    """Return the common mistake behind a wrong end of a goal."""
    got, cancel = _ended_as(goal), goal.cancels[0] if goal.cancels else None
    if {state.state for state in goal.states} in ({"accepted"}, {"accepted", "canceling"}):
        return _NOT_EXECUTED
    if expected == "canceled" and cancel:
        return _why_not_canceled(goal, cancel, got)
    if expected == "succeeded" and got == "aborted":
        return _FORGOT if _NO_STATE in run.recording.log else _GAVE_UP
    if _ended_at(goal) is not None or expected == "aborted":
        return UNKNOWN
    return _STUCK if _does_nothing_after(run, goal) else _NEVER


def _does_nothing_after(run: RecordedRun, goal: Goal) -> bool:
    """Return whether the goal is executed, and the node does nothing after that, or after some feedback."""
    begun = next((state.at for state in goal.states if state.state == "executing"), None)
    if begun is None:
        return False
    last = max([begun, *(feedback.at for feedback in goal.feedback)])
    if goal.feedback and not any(item.at > last for item in _solutions(run, goal.number).feedback):
        return False
    answers = [other.at for other in run.recording.goals if other.accepted is not None and other.at > last]
    return not answers and not any(message.at > last for message in run.recording.received)


def _solutions(run: RecordedRun, number: int) -> Goal:
    return next(goal for goal in run.reference.goals if goal.number == number and goal.by == "grader")


def _reference_goals(run: RecordedRun, action: str, by: By) -> tuple[Goal, ...]:
    return tuple(goal for goal in run.reference.goals if goal.action == action and goal.by == by)


def _why_not_canceled(goal: Goal, cancel: Cancel, got: str) -> Cause:
    ended = _ended_at(goal)
    if ended is not None and ended < cancel.at:
        return _OVER
    if cancel.answered is None:
        return _NO_ANSWER
    if ended is not None and cancel.answered >= ended > cancel.at:
        return _TOO_LATE
    if cancel.accepted is False:
        return _REFUSED
    return {"succeeded": _DISREGARDED, "aborted": UNKNOWN, "canceled": UNKNOWN}.get(got, _WENT_ON)


def _part(goal: Goal) -> str:
    return f"goal {goal.number} for {goal.action} ({shown(goal.goal) if goal.goal else 'empty'})"


def _ended_as(goal: Goal) -> str:
    last = goal.states[-1].state if goal.states else ""
    return last if last in ("succeeded", "canceled", "aborted") else goal.status or f"no end{last and f', but {last}'}"


def _ended_at(goal: Goal) -> float | None:
    ends = [state.at for state in goal.states if state.state in ("succeeded", "canceled", "aborted")]
    return ends[0] if ends else goal.finished
