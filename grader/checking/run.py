"""What a check gets for one scenario: the recording, and every helper as a method.

A helper is a function of a `RecordedRun`, in the module of its subject. One line here makes it a method.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from grader.checking import actions, answers, closed_loops, graph, life_cycle, parameters, series, services
from grader.checking.message import Exchange, Message
from grader.checking.recorded_run import RecordedRun

__all__ = ["Exchange", "Message", "Run"]


class Run(RecordedRun):
    """What happened in one scenario. Iterate over it to get each `Exchange`."""

    def __iter__(self) -> Iterator[Exchange]:
        return iter(self.exchanges)

    def on(self, topic: str) -> Run:
        """Return the same run with only the messages on `topic`, for a node that publishes on several topics.

        Example: `run.on("/out").must_match("data")`
        """
        name = self.existing("topic", topic)
        student, solution = (
            replace(recording, received=tuple(message for message in recording.received if message.topic == name))
            for recording in (self.recording, self.reference)
        )
        return replace(self, recording=student, reference=solution)

    must_match = answers.must_match
    must_answer = answers.must_answer
    must_answer_at_once = answers.must_answer_at_once
    must_vary = answers.must_vary
    must_be_silent = answers.must_be_silent
    must_be_silent_at_first = answers.must_be_silent_at_first

    must_publish = series.must_publish
    must_match_series = series.must_match_series
    must_keep_rate = series.must_keep_rate
    must_have_no_gap = series.must_have_no_gap
    must_stamp = series.must_stamp

    calls = services.calls
    must_respond = services.must_respond
    must_match_responses = services.must_match_responses
    must_call = services.must_call
    must_match_requests = services.must_match_requests

    must_transition = life_cycle.must_transition

    goals = actions.goals
    goal = actions.scenario_goal
    must_accept = actions.must_accept
    must_reject = actions.must_reject
    must_go_through = actions.must_go_through
    must_end = actions.must_end
    must_cancel = actions.must_cancel
    must_match_results = actions.must_match_results
    must_match_feedback = actions.must_match_feedback
    must_match_goals = actions.must_match_goals
    must_ask_only_for_accepted = actions.must_ask_only_for_accepted

    must_take = parameters.must_take
    must_refuse = parameters.must_refuse
    must_take_and_refuse_as_the_solution = parameters.must_take_and_refuse_as_the_solution
    must_have_parameter = parameters.must_have_parameter

    trajectory = closed_loops.trajectory
    must_reach = closed_loops.must_reach
    must_stay_between = closed_loops.must_stay_between
    must_estimate = closed_loops.must_estimate
    must_steer = closed_loops.must_steer
    steers_away = closed_loops.steers_away

    end_points = graph.end_points
    publishers = graph.publishers
    subscriptions = graph.subscriptions
    topics = graph.topics
    must_be_as_declared = graph.must_be_as_declared
    must_have_interface = graph.must_have_interface
    must_have_qos = graph.must_have_qos
    must_have_nodes = graph.must_have_nodes
    must_publish_on_no_others = graph.must_publish_on_no_others
    must_end_on_ctrl_c = graph.must_end_on_ctrl_c
    must_survive = graph.must_survive
