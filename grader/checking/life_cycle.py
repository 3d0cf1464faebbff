"""Helpers for nodes with a life cycle."""

from __future__ import annotations

from grader.checking.cause import Cause
from grader.checking.hint_texts import hints
from grader.checking.partial import each
from grader.checking.recorded_run import RecordedRun
from grader.recording.events import Call
from grader.recording.types import CHANGE_STATE


def must_transition(run: RecordedRun, name: str = "") -> None:
    """Check that the node does each of the scenario's transitions, or refuses it, as the solution does.

    With a `name`, only transitions of this name count.

    Example: `run.must_transition("activate")`
    """

    def judge(pair: tuple[Call, Call]) -> None:
        call, reference = pair
        part, expected, got = f"the transition {_label(call)}", _outcome(reference), _outcome(call)
        if got != expected:
            text = f"expected that it is {expected}, got {got}."
            run.wrong_at(call.at, text, part, expected, got, _cause(call, got))

    if not any(_counts(call, name) for call in run.reference.calls):
        raise ValueError(f"the scenario {run.scenario} asks for no transition{f' {name}' if name else ''}.")
    pairs = zip(run.recording.calls, run.reference.calls, strict=False)
    each([pair for pair in pairs if _counts(pair[0], name)], judge)


def _counts(call: Call, name: str) -> bool:
    """Return whether a call asks for a transition of this name; without one, for any."""
    is_transition = call.by == "grader" and call.service.endswith(f"/{CHANGE_STATE}")
    return is_transition and name in ("", _label(call))


def _label(call: Call) -> str:
    return str(call.request["transition"]["label"])


def _outcome(call: Call) -> str:
    if call.response is None:
        return "not answered"
    return "done" if call.response["success"] else "refused"


def _cause(call: Call, got: str) -> Cause:
    name = _label(call)
    if not call.served:
        node = call.service.removesuffix(f"/{CHANGE_STATE}")
        return Cause(f"{node} is not there, or has no life cycle.", *hints("no_life_cycle"))
    seen = f"on_{name}() did not return SUCCESS, or the node was in another state." if got == "refused" else ""
    return Cause(seen, *hints("transition", transition=name))
