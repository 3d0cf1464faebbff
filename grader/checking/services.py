"""Helpers for services: the responses of the student's server, and the requests of the student's client."""

from __future__ import annotations

from typing import Any

from grader.checking.comparator import TOLERANCE, shown
from grader.checking.recorded import Recorded
from grader.recording.events import By, Call
from grader.scenario.times import SECOND


class ServiceChecks(Recorded):
    """Requests and responses. Without a `service` it is the only one that exercise.toml declares."""

    def calls(self, service: str = "", by: By = "grader") -> tuple[Call, ...]:
        """The scenario's calls of the student's service, in order; `by="node"` for the requests of the student's."""
        name = service or self.only("service" if by == "grader" else "client")
        return tuple(call for call in self.recording.calls if call.service == name and call.by == by)

    def must_respond(self, service: str = "", within: float | None = None) -> None:
        """The node must respond to every request that the solution responds to, within this many seconds."""
        for number, call, reference in self._numbered(service, "grader"):
            if reference.answered is None:
                continue
            if call.answered is None:
                self._no_response(number, call)
                continue
            late = (call.answered - call.at) / SECOND
            if within is not None and late > within + 1e-9:
                text = f"a response was expected within {within:g} s, got it {late:.2f} s after the request."
                self.wrong_at(
                    call.at, text, _part(number, call), f"{within:g} s", f"{late:.2f} s", self._all_late(call)
                )

    def must_match_responses(self, field: str = "", service: str = "", tolerance: float = TOLERANCE) -> None:
        """Every response must have the same `field` as the solution's; without one, every field counts."""
        calls = self._numbered(service, "grader")
        pairs = [(r.response, c.response) for _, c, r in calls if r.response is not None and c.response is not None]
        for number, call, reference in calls:
            if reference.response is None:
                continue
            if call.response is None:
                self._no_response(number, call)
                continue
            part, got, expected = _part(number, call), call.response, reference.response
            self.compare_at(call.at, part, field, got, expected, tolerance, call.service, pairs)

    def must_call(self, service: str = "", count: int | None = None) -> None:
        """The node must call a reference server: `count` times, or as often as the solution does."""
        name = service or self.only("client")
        got = self.calls(name, by="node")
        wanted = count if count is not None else len(self._reference_calls(name, "node"))
        if len(got) == wanted:
            return
        text = f"expected {wanted} requests to {name}, got {len(got)}."
        clients = sorted({end.topic for end in self.recording.end_points if end.kind == "client"})
        never = "" if got or name in clients else f"Your node has no client for {name}. Its clients are for: "
        never += (", ".join(clients) or "none") + "." if never else ""
        self.wrong_at(None, text, "", f"{wanted} requests", len(got), never or self.waits())

    def must_match_requests(
        self, field: str = "", service: str = "", tolerance: float = TOLERANCE, time: float | None = None
    ) -> None:
        """The node's first request must have the same `field` as the solution's first, and so on.

        With `time`, each must arrive within this many seconds of the solution's.
        """
        self.must_call(service)
        calls = self._numbered(service, "node")
        pairs = [(reference.request, call.request) for _, call, reference in calls]
        for number, call, reference in calls:
            part = f"request {number} to {call.service}"
            self.compare_at(call.at, part, field, call.request, reference.request, tolerance, call.service, pairs)
            self.time_at(call.at, reference.at, part, time)

    def _numbered(self, service: str, by: By) -> list[tuple[int, Call, Call]]:
        """(number from 1, the student's, the solution's) of each call."""
        name = service or self.only("service" if by == "grader" else "client")
        pairs = zip(self.calls(name, by), self._reference_calls(name, by), strict=False)
        return [(number, call, reference) for number, (call, reference) in enumerate(pairs, start=1)]

    def _reference_calls(self, service: str, by: By) -> tuple[Call, ...]:
        return tuple(call for call in self._reference.calls if call.service == service and call.by == by)

    def _no_response(self, number: int, call: Call) -> None:
        servers = sorted({end.topic for end in self.recording.end_points if end.kind == "server"})
        same = [other for other in self.calls(call.service) if other.answered is not None]
        if not call.served or call.service not in servers:
            names = ", ".join(servers) or "none"
            text = f"your node has no service {call.service}. Its services are: {names}."
            self.wrong_at(call.at, text, "", call.service, names)
        never = "" if same else "Your node never responds. Does the callback return the response, without blocking?"
        text = "a response was expected, got none."
        self.wrong_at(call.at, text, _part(number, call), "a response", "none", never)

    def _all_late(self, call: Call) -> str:
        late = [(one.answered - one.at) / SECOND for one in self.calls(call.service) if one.answered is not None]
        if len(late) < 3 or max(late) - min(late) > 0.02 * max(late):
            return ""
        return f"Every response comes {late[0]:.2f} s after its request."


def _part(number: int, call: Call) -> str:
    return f"request {number} to {call.service} ({shown(_plain(call.request))})"


def _plain(request: dict[str, Any]) -> Any:
    return request or "empty"
