"""Helpers for services: the responses of the student's server, and the requests of the student's client."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NoReturn

from grader.checking.cause import Cause
from grader.checking.comparator import TOLERANCE, shown
from grader.checking.graph import lacking, shown_names, topics
from grader.checking.hint_texts import hints
from grader.checking.partial import each
from grader.checking.recorded_run import RecordedRun
from grader.recording.events import By, Call

_NEVER_RESPONDS = Cause(
    "Your node never responds. Does the callback return the response, without blocking?", *hints("never_responds")
)


def calls(run: RecordedRun, service: str = "", by: By = "grader") -> tuple[Call, ...]:
    """Return the scenario's calls of the student's service, in order; with `by="node"`, the requests of the
    student's node.

    Example: `run.calls("/add")[0].response["sum"]`
    """
    name = run.existing("service", service or run.only("service" if by == "grader" else "client"))
    return tuple(call for call in run.recording.calls if call.service == name and call.by == by)


def must_respond(run: RecordedRun, service: str = "", within: float | None = None) -> None:
    """Check that the node responds to every request that the solution responds to, within this many seconds.

    Example: `run.must_respond(within=0.1)`
    """

    def judge(numbered: tuple[int, Call, Call]) -> None:
        number, call, reference = numbered
        if reference.answered is None:
            return
        if call.answered is None:
            _no_response(run, number, call)
        late = call.answered - call.at
        if within is not None and late > within + 1e-9:
            text = f"a response was expected within {within:g} s, got it {late:.2f} s after the request."
            run.wrong_at(call.at, text, _part(number, call), f"{within:g} s", f"{late:.2f} s", _all_late(run, call))

    each(_numbered(run, service, "grader"), judge)


def must_match_responses(run: RecordedRun, field: str = "", service: str = "", tolerance: float = TOLERANCE) -> None:
    """Check that every response has the same `field` as the solution's. By default every field counts.

    Example: `run.must_match_responses("sum")`
    """
    numbered = _numbered(run, service, "grader")
    pairs = [(r.response, c.response) for _, c, r in numbered if r.response is not None and c.response is not None]

    def judge(one: tuple[int, Call, Call]) -> None:
        number, call, reference = one
        if reference.response is None:
            return
        if call.response is None:
            _no_response(run, number, call)
        part, got, expected = _part(number, call), call.response, reference.response
        run.compare_at(call.at, part, field, got, expected, tolerance, call.service, pairs)

    each(numbered, judge)


def must_call(run: RecordedRun, service: str = "", count: int | None = None) -> None:
    """Check that the node calls a reference server: `count` times, or as often as the solution does.

    Example: `run.must_call("/ask", count=1)`
    """
    name = service or run.only("client")
    got = calls(run, name, by="node")
    expected = count if count is not None else len(_reference_calls(run, name, "node"))
    if len(got) == expected:
        return
    text = f"expected {expected} requests to {name}, got {len(got)}."
    never = f"Your node has no client for {name}. Its clients are for: {shown_names(run, 'client')}."
    lacks = not got and name not in topics(run, "client")
    cause = replace(lacking("client"), seen=never) if lacks else run.waits()
    run.wrong_at(None, text, "", f"{expected} requests", len(got), cause)


def must_match_requests(
    run: RecordedRun, field: str = "", service: str = "", tolerance: float = TOLERANCE, time: float | None = None
) -> None:
    """Check that the node's first request has the same `field` as the solution's first, and so on.

    With `time`, each must arrive within this many seconds of the solution's.

    Example: `run.must_match_requests("a", "/ask", time=0.1)`
    """
    must_call(run, service)
    numbered = _numbered(run, service, "node")
    pairs = [(reference.request, call.request) for _, call, reference in numbered]
    for number, call, reference in numbered:
        part = f"request {number} to {call.service}"
        run.compare_at(call.at, part, field, call.request, reference.request, tolerance, call.service, pairs)
        run.time_at(call.at, reference.at, part, time)


def _numbered(run: RecordedRun, service: str, by: By) -> list[tuple[int, Call, Call]]:
    """Return (number from 1, the student's, the solution's) of each call."""
    name = service or run.only("service" if by == "grader" else "client")
    references = _reference_calls(run, name, by)
    pairs = zip(calls(run, name, by), references, strict=False)
    if by == "grader" and not references:
        raise ValueError(f"the scenario {run.scenario} never calls {name}. Add a step: at(0.5).call({name!r}, …).")
    return [(number, call, reference) for number, (call, reference) in enumerate(pairs, start=1)]


def _reference_calls(run: RecordedRun, service: str, by: By) -> tuple[Call, ...]:
    return tuple(call for call in run.reference.calls if call.service == service and call.by == by)


def _no_response(run: RecordedRun, number: int, call: Call) -> NoReturn:
    every = calls(run, call.service)
    answered = sum(other.answered is not None for other in every)
    if not call.served or call.service not in topics(run, "server"):
        names = shown_names(run, "server")
        text = f"your node has no service {call.service}. Its services are: {names}."
        run.wrong_at(call.at, text, "", call.service, names, lacking("server"))
    some = f"Your node responds to {answered} of {len(every)} requests. Does its callback wait or sleep?"
    cause = Cause(some, *hints("gap")) if answered else _NEVER_RESPONDS
    text = "a response was expected, got none."
    run.wrong_at(call.at, text, _part(number, call), "a response", "none", cause)


def _all_late(run: RecordedRun, call: Call) -> str:
    late = [c.answered - c.at for c in calls(run, call.service) if c.answered is not None]
    if len(late) < 3 or max(late) - min(late) > 0.02 * max(late):
        return ""
    return f"Every response comes {late[0]:.2f} s after its request."


def _part(number: int, call: Call) -> str:
    return f"request {number} to {call.service} ({shown(_plain(call.request))})"


def _plain(request: dict[str, Any]) -> Any:
    return request or "empty"
