"""What the helpers for actions say: every trap of an action server, as raw status, feedback and responses show it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from made_up import COUNT, EMPTY, EXERCISE, finding, ns, run, says

from grader.exercise.exercise import ServiceOrAction
from grader.recording import Ending, Recording
from grader.recording.events import Cancel, Feedback, Goal, GoalState

CLIENT = replace(EXERCISE, endpoints=(ServiceOrAction("/count", COUNT, "action_client"),))


def goal(*states: tuple[float, str], **fields: Any) -> Recording:
    """A goal sent at 1 s that went through these states."""
    ends = [at for at, state in states if state in ("succeeded", "canceled", "aborted")]
    status = states[-1][1] if states else ""
    given: dict[str, Any] = {
        "accepted": True,
        "states": tuple(GoalState(ns(at), state) for at, state in states),
        "status": status if ends else "",
        "result": {"sequence": [0, 1, 1]} if ends else None,
        "finished_ns": ns(ends[0]) if ends else None,
        "feedback": tuple(Feedback(ns(1.5 + i / 2), {"left": 2 - i}) for i in range(2)),
    }
    return replace(EMPTY, goals=(Goal(1, ns(1.0), "/count", COUNT, {"order": 3}, "grader", **{**given, **fields}),))


def changed(recording: Recording, **fields: Any) -> Recording:
    return replace(recording, goals=tuple(replace(one, **fields) for one in recording.goals))


BEGIN = ((1.0, "accepted"), (1.0, "executing"))
RIGHT = goal(*BEGIN, (3.0, "succeeded"))
ASKED = (Cancel(ns(2.0), ns(2.0), accepted=True, code=0),)
CANCELED = goal(*BEGIN, (2.0, "canceling"), (2.2, "canceled"), cancels=ASKED)
PART = "goal 1 for /count (order 3)"


def test_a_right_server_passes() -> None:
    mine = run(RIGHT)
    mine.must_accept()
    mine.must_go_through("accepted", "executing", "succeeded")
    mine.must_go_through()
    mine.must_end("succeeded", within=2.0)
    mine.must_match_results()
    mine.must_match_feedback("left", time=0.0)
    run(CANCELED).must_cancel(within=0.5)
    run(changed(RIGHT, accepted=False)).must_reject()


FORGOT = "[WARN] [worker.action_server]: Goal state not set, assuming aborted. Goal ID: [0 0 1]\n"


def test_succeed_is_forgotten() -> None:
    mine = run(replace(goal(*BEGIN, (3.0, "aborted")), log=FORGOT), RIGHT)
    forgot = "Your execute callback returned without goal_handle.succeed(), so rclpy aborted the goal."
    assert says(lambda: mine.must_end("succeeded")) == (
        f"At 3.00 s (as usual), {PART}: it was expected to end as succeeded, got aborted. {forgot}"
    )
    found = finding(lambda: mine.must_go_through("accepted", "executing", "succeeded"))
    assert found.text.startswith(f"At 3.00 s (as usual), {PART}: expected the states accepted → executing → succeeded")
    assert found.text.endswith(forgot)
    assert (found.expected, found.got) == ("accepted → executing → succeeded", "accepted → executing → aborted")


def test_abort_is_called_at_the_end() -> None:
    mine = goal(*BEGIN, (3.0, "aborted"))
    assert says(lambda: run(mine, RIGHT).must_end("succeeded")).endswith(
        "Your execute callback called goal_handle.abort(), which is for a goal that it gives up."
    )


@pytest.mark.parametrize(
    ("mine", "message"),
    [
        (goal(*BEGIN, (3.0, "succeeded"), cancels=(replace(ASKED[0], accepted=False, code=0),)),
         "got succeeded. Your node rejected the request to cancel: without a cancel callback, a server rejects every"),
        (goal(*BEGIN, (2.0, "canceling"), (3.0, "succeeded"), cancels=ASKED),
         "got succeeded. Your node accepted the request to cancel, and then called succeed() anyway."),
        (goal(*BEGIN, (3.24, "succeeded"), cancels=(Cancel(ns(2.0), ns(3.24), accepted=False, code=3),)),
         "Your node answered the request to cancel only after the goal had ended: execute blocks the executor."),
        (goal(*BEGIN, (2.0, "canceling"), (2.9, "canceled"), cancels=ASKED),
         "it was expected to end within 0.5 s of the request to cancel, got 0.90 s."),
        (goal(*BEGIN, (2.0, "canceling"), cancels=ASKED), "but continued: execute must check goal_handle.is_can"),
        (goal(*BEGIN, cancels=(Cancel(ns(2.0)),)), "never answered the request to cancel: execute blocks the"),
        (goal(*BEGIN, (1.0, "aborted"), cancels=(Cancel(ns(2.0), ns(2.0), accepted=False, code=3),)),
         "got aborted. The goal had ended before the request to cancel arrived."),
        (replace(CANCELED, goals=(replace(CANCELED.goals[0], feedback=(Feedback(ns(2.5), {"left": 0}),)),)),
         "At 2.50 s (as usual), goal 1 for /count (order 3): no feedback was expected after the goal was canceled"),
    ],
    ids=["rejected", "succeed all the same", "answered late", "slow", "ignored", "single-threaded", "over", "feedback"],
)  # fmt: skip
def test_a_request_to_cancel_that_is_not_obeyed(mine: Recording, message: str) -> None:
    assert message in says(lambda: run(mine, CANCELED).must_cancel(within=0.5))


def test_a_goal_that_never_ends_or_ends_late() -> None:
    assert says(lambda: run(goal(*BEGIN), RIGHT).must_end("succeeded")).endswith(
        "got no end, but executing. The goal never ended."
    )
    assert "it was expected to end within 1.5 s, got 2.00 s." in says(
        lambda: run(RIGHT).must_end("succeeded", within=1.5)
    )


def test_a_bad_goal_is_accepted_and_a_good_one_is_not() -> None:
    assert "it must be rejected, but your node accepted it." in says(lambda: run(RIGHT).must_reject())
    refused = run(changed(RIGHT, accepted=False, states=()), RIGHT)
    assert "it must be accepted, but your node rejected it." in says(lambda: refused.must_end("succeeded"))


def test_no_answer_to_a_goal() -> None:
    mute = changed(RIGHT, accepted=None, states=())
    assert "your node never said whether it accepts the goal." in says(lambda: run(mute, RIGHT).must_accept())
    absent = replace(mute, end_points=())
    assert "your node has no action /count. Its actions are: none." in says(lambda: run(absent, RIGHT).must_accept())


@pytest.mark.parametrize(
    ("feedback", "message"),
    [
        ((), "expected 2 feedback messages, got 0. Your node never publishes feedback."),
        ((Feedback(ns(1.5), {"left": 2}),), "expected 2 feedback messages, got 1."),
        ((Feedback(ns(1.5), {"left": 2}), Feedback(ns(2.0), {"left": 7})), "feedback 2: expected left 1, got 7."),
        (
            (Feedback(ns(1.5), {"left": 2}), Feedback(ns(2.4), {"left": 1})),
            "expected at 2.00 s, but happened at 2.40 s.",
        ),
        (
            (Feedback(ns(1.4), {"left": 2}),),
            "but happened at 1.40 s. Does your node wait by the computer's clock, such as with",
        ),
    ],
)
def test_feedback(feedback: tuple[Feedback, ...], message: str) -> None:
    assert message in says(lambda: run(changed(RIGHT, feedback=feedback), RIGHT).must_match_feedback("left", time=0.05))


def test_results() -> None:
    other = changed(RIGHT, result={"sequence": [0, 1, 2]})
    assert "its result: expected sequence[2] 1, got 2." in says(lambda: run(other, RIGHT).must_match_results())
    assert "a result was expected, got none." in says(lambda: run(goal(*BEGIN), RIGHT).must_match_results())
    rejected = goal(accepted=False)
    assert says(lambda: run(rejected, RIGHT).must_match_results()).endswith(
        "it must be accepted, but your node rejected it."
    )


def test_what_execute_raised_is_said_by_each_check() -> None:
    message = "Your execute callback raised an exception: no joint."
    raised = replace(
        goal(*BEGIN, (1.5, "aborted"), result={"sequence": []}), ending=Ending("completed", survived=message)
    )
    assert says(lambda: run(raised, RIGHT).must_end("succeeded")).endswith(message)
    assert says(lambda: run(raised, RIGHT).must_match_results()).endswith(message)


def test_a_node_whose_only_thread_waits_in_execute() -> None:
    stuck = changed(goal(*BEGIN), feedback=())
    assert says(lambda: run(stuck, RIGHT).must_end("succeeded")).endswith("run the node in a MultiThreadedExecutor.")
    once = changed(goal(*BEGIN), feedback=goal().goals[0].feedback[:1])
    assert says(lambda: run(once, RIGHT).must_end("succeeded")).endswith("run the node in a MultiThreadedExecutor.")
    assert says(lambda: run(goal(*BEGIN), RIGHT).must_end("succeeded")).endswith("The goal never ended.")
    assert says(lambda: run(goal(*BEGIN), RIGHT).must_end("aborted")).endswith("got no end, but executing.")


def test_goals_of_a_client() -> None:
    right = changed(RIGHT, by="node")
    run(right, exercise=CLIENT).must_match_goals("order")
    run(right, exercise=CLIENT).must_ask_only_for_accepted()
    later = replace(right, goals=(*right.goals, replace(right.goals[0], at_ns=ns(9.0))))
    for accepted in (True, False):
        asked = run(changed(goal(), by="node", accepted=accepted, feedback=()), later, CLIENT)
        assert bool(asked.waits()) == accepted, "a goal that was rejected is over"
    other = changed(right, goal={"order": 4})
    assert "its goal: expected order 3, got 4." in says(lambda: run(other, right, CLIENT).must_match_goals())
    none = replace(right, goals=())
    assert "expected 1 goals for /count, got 0. Your node has no action client for /count." in says(
        lambda: run(none, right, CLIENT).must_match_goals()
    )
    ignoring = changed(right, accepted=False, asked_result_ns=ns(1.1))
    assert "it was rejected, but your node asked for its result." in says(
        lambda: run(ignoring, right, CLIENT).must_ask_only_for_accepted()
    )


def test_an_author_who_asks_for_a_goal_or_a_cancel_that_is_not_there_is_reported() -> None:
    with pytest.raises(ValueError, match="there is no goal 2: the scenario plain sends fewer"):
        run(RIGHT).must_accept(2)
    with pytest.raises(ValueError, match="the scenario plain never asks to cancel goal 1"):
        run(RIGHT).must_cancel(1)
