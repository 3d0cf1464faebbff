"""Reference servers of services: they answer the student's requests as the scenario says."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from grader.exercise.exercise import Exercise
from grader.recording.events import Call
from grader.runner.cdr import deserialized, fields_of, serialized
from grader.runner.grader_side import GraderSide, Schedule, nanoseconds
from grader.runner.message import message_class, to_fields
from grader.runner.message_order import requests_in_order
from grader.runner.program import AuthorFault, CannotContinue
from grader.scenario.code import AuthorCode
from grader.scenario.servers import Reply
from grader.scenario.servers import Server as Declared
from grader.scenario.values import InvalidValue, checked_fields
from rmw_lockstep.hub import HubServer, PendingRequest

#: No exercise needs more calls of one service from a node in one scenario, and no more bytes in the answers.
MOST_CALLS, MOST_BYTES = 5_000, 8_000_000


class ServiceServer:
    """One reference server."""

    def __init__(self, ends: GraderSide, schedule: Schedule, declared: Declared) -> None:
        self.name = declared.service
        self._ends, self._schedule, self._declared = ends, schedule, declared
        self._kind = message_class(declared.type)
        self._answer = declared.replies.load() if isinstance(declared.replies, AuthorCode) else None
        self._server: HubServer | None = None
        self._calls: list[Call] = []
        self._bytes = 0

    def open(self) -> None:
        """Start the server."""
        if self._server is None:
            self._server = self._ends.node.server(self.name, self._declared.type)

    def close(self) -> None:
        """Stop the server, and drop every answer that it has not sent yet."""
        if self._server is not None:
            self._server.close()
            self._server = None

    def react(self, now: int) -> bool:
        """Take the requests that arrived, and plan the answers. Return whether there were any."""
        asked = self._server.asked if self._server else []
        requests, asked[:] = requests_in_order(asked), []
        for one in requests:
            self._take(one, now)
        return bool(requests)

    def _take(self, asked: PendingRequest, now: int) -> None:
        if len(self._calls) >= MOST_CALLS:
            raise CannotContinue("over-limit", f"Your node called {self.name} more than {MOST_CALLS:,} times.")
        request = deserialized(asked.cdr, self._kind.Request)
        at = self._ends.at(asked.moment)
        call = Call(at, self.name, self._declared.type, to_fields(request), "node", node=asked.node)
        self._calls.append(call)
        number = len(self._calls)
        reply = self._reply(request, number)
        if reply.fields is not None:
            server = self._server
            due = max(now, at + nanoseconds(reply.after))
            self._schedule.plan(due, lambda moment: self._respond(server, asked, number, reply, moment))

    def _respond(self, server: HubServer | None, asked: PendingRequest, number: int, reply: Reply, now: int) -> None:
        if server is None or server is not self._server:
            return
        fields = reply.fields or {}
        message = serialized(self._kind.Response, fields)
        self._bytes += len(message)
        if self._bytes > MOST_BYTES:
            text = f"Your node called {self.name} so often that the answers take more than {MOST_BYTES:,} bytes."
            raise CannotContinue("over-limit", text)
        server.respond(asked, message)
        response = fields_of(message, self._kind.Response)
        self._calls[number - 1] = replace(self._calls[number - 1], answered_ns=now, response=response)

    def _reply(self, request: Any, number: int) -> Reply:
        if self._answer is not None:
            return self._from_code(self._answer, request)
        replies = self._declared.replies
        assert isinstance(replies, tuple)
        return replies[min(number, len(replies)) - 1] if replies else Reply(0.0, {})

    def _from_code(self, answer: Any, request: Any) -> Reply:
        try:
            found = answer(request)
            reply = found if isinstance(found, Reply) else Reply(0.0, found)
            if reply.fields is not None:
                name = f"{self._declared.type}_Response"
                return replace(reply, fields=checked_fields(self._kind.Response, reply.fields, name))
        except InvalidValue as error:
            raise AuthorFault(f"{self._place(answer, request)}: {error.problem}. {error.fix}") from None
        except Exception as error:
            raise AuthorFault(f"{self._place(answer, request)}: {type(error).__name__}: {error}") from error
        return reply

    def _place(self, answer: Any, request: Any) -> str:
        return f"{answer.__name__}() for {self.name}, with the request {to_fields(request)}"

    def calls(self) -> tuple[Call, ...]:
        """Return every request that arrived, and its answer."""
        return tuple(self._calls)


def unserved(ends: GraderSide, exercise: Exercise) -> tuple[Call, ...]:
    """Return the student's requests for which there was no server, of the services that the exercise declares."""
    types = {client.name: client.type for client in exercise.of_role("client")}
    everything = requests_in_order(ends.hub.unserved)
    declared = [asked for asked in everything if types.get(asked.client.name) == asked.client.type]
    return tuple(
        Call(
            ends.at(asked.moment),
            asked.client.name,
            asked.client.type,
            fields_of(asked.cdr, message_class(asked.client.type).Request),
            "node",
            node=asked.node,
            served=False,
        )
        for asked in declared
    )
