"""What the helper for nodes with a life cycle says."""

from __future__ import annotations

from dataclasses import replace

import pytest
from made_up import EMPTY, ns, run, says

from grader.recording import Recording
from grader.recording.events import Call

CHANGE = ("/worker/change_state", "lifecycle_msgs/srv/ChangeState")


def transitions(*done: bool | None, served: bool = True) -> Recording:
    """Configured and activated, with these outcomes; None stands for no answer."""
    names = ("configure", "activate")
    calls = tuple(
        Call(
            *(ns(second), *CHANGE, {"transition": {"label": name}}, "grader"),
            answered_ns=None if success is None else ns(second),
            response=None if success is None else {"success": success},
            served=served,
        )
        for second, (name, success) in enumerate(zip(names, done, strict=True), start=1)
    )
    return replace(EMPTY, calls=calls)


RIGHT = transitions(True, True)


@pytest.mark.parametrize(
    ("mine", "message"),
    [
        (
            transitions(True, False),
            "the transition activate: expected that it is done, got refused. on_activate()",
        ),
        (transitions(None, None, served=False), "/worker is not there, or has no life cycle."),
        (transitions(True, None), "the transition activate: expected that it is done, got not answered."),
    ],
)
def test_a_transition_that_differs_is_named(mine: Recording, message: str) -> None:
    assert message in says(lambda: run(mine, RIGHT).must_transition())


def test_a_transition_may_be_refused_if_the_solution_refuses_it() -> None:
    run(transitions(True, False), transitions(True, False)).must_transition()
    run(transitions(True, False), RIGHT).must_transition("configure")
