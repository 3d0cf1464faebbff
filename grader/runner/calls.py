"""Calls the student's services, and the services that set and read parameters."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from typing import Any, TypeAlias

from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import GetParameters, SetParameters
from rclpy.parameter import parameter_value_to_python
from rclpy.serialization import serialize_message

from grader.recording.events import Call, ParameterChange, ParameterReading
from grader.runner.cdr import deserialized, fields_of, serialized
from grader.runner.grader_side import GraderSide
from grader.runner.message import message_class
from grader.scenario.scenario import GetParameter, Request, Scenario, SetParameter
from rmw_lockstep.hub import HubClient

#: The steps that `Calls` carries out.
CallStep: TypeAlias = Request | SetParameter | GetParameter

SET, GET = "rcl_interfaces/srv/SetParameters", "rcl_interfaces/srv/GetParameters"


@dataclass(frozen=True)
class PendingCall:
    """A call that was made; `number` is None when there was no server."""

    step: Request | SetParameter | GetParameter
    client: HubClient
    number: int | None

    @property
    def cdr(self) -> bytes | None:
        """The response, if any."""
        return None if self.number is None else self.client.answers.get(self.number)


class Calls:
    """Makes calls, and records their outcomes. All clients exist from the beginning."""

    def __init__(self, ends: GraderSide, scenario: Scenario) -> None:
        self._ends = ends
        self._clients: dict[str, HubClient] = {}
        self._made: list[PendingCall] = []
        for step in scenario.steps:
            if isinstance(step, (Request, SetParameter, GetParameter)):
                self._client(step)

    def _client(self, step: Request | SetParameter | GetParameter) -> HubClient:
        service, type_name = _service_of(step)
        if service not in self._clients:
            self._clients[service] = self._ends.node.client(service, type_name)
        return self._clients[service]

    def make(self, step: CallStep) -> None:
        """Send one request."""
        client = self._client(step)
        self._made.append(PendingCall(step, client, client.call(_request_of(step))))

    def _answered(self, made: PendingCall) -> int | None:
        if made.number is None or made.number not in made.client.moments:
            return None
        return max(made.step.at, self._ends.at(made.client.moments[made.number]))

    def calls(self) -> tuple[Call, ...]:
        """Return all calls of the student's services, in order."""
        return tuple(self._call(made, made.step) for made in self._made if isinstance(made.step, Request))

    def _call(self, made: PendingCall, step: Request) -> Call:
        kind = message_class(step.type).Response
        response = None if made.cdr is None else fields_of(made.cdr, kind)
        served = made.number is not None
        return Call(step.at, step.service, step.type, step.fields, "grader", self._answered(made), response, "", served)

    def changes(self) -> tuple[ParameterChange, ...]:
        """Return the parameters that were set, and the node's answers."""
        return tuple(self._change(made, made.step) for made in self._made if isinstance(made.step, SetParameter))

    def _change(self, made: PendingCall, step: SetParameter) -> ParameterChange:
        results = [] if made.cdr is None else list(deserialized(made.cdr, SetParameters.Response).results)
        taken, reason = (bool(results[0].successful), str(results[0].reason)) if results else (None, "")
        return ParameterChange(step.at, step.node, step.name, step.value, taken, reason, self._answered(made))

    def readings(self) -> tuple[ParameterReading, ...]:
        """Return the parameters that were read, and the node's answers."""
        return tuple(self._reading(made, made.step) for made in self._made if isinstance(made.step, GetParameter))

    def _reading(self, made: PendingCall, step: GetParameter) -> ParameterReading:
        values = [] if made.cdr is None else list(deserialized(made.cdr, GetParameters.Response).values)
        value = from_parameter_value(values[0]) if values else None
        return ParameterReading(step.at, step.node, step.name, value, self._answered(made))


def _service_of(step: Request | SetParameter | GetParameter) -> tuple[str, str]:
    if isinstance(step, Request):
        return step.service, step.type
    if isinstance(step, SetParameter):
        return f"{step.node}/set_parameters", SET
    return f"{step.node}/get_parameters", GET


def _request_of(step: Request | SetParameter | GetParameter) -> bytes:
    if isinstance(step, Request):
        return serialized(message_class(step.type).Request, step.fields)
    if isinstance(step, SetParameter):
        parameter = Parameter(name=step.name, value=to_parameter_value(step.value))
        content: bytes = serialize_message(SetParameters.Request(parameters=[parameter]))
        return content
    asked: bytes = serialize_message(GetParameters.Request(names=[step.name]))
    return asked


_OF_PYTHON = {bool: "bool", int: "integer", float: "double", str: "string"}


def to_parameter_value(value: Any) -> ParameterValue:
    """Return a Python value as a parameter value. An empty list becomes an array of strings."""
    if isinstance(value, (list, tuple)):
        name = f"{_OF_PYTHON[type(value[0])]}_array" if value else "string_array"
    else:
        name = _OF_PYTHON[type(value)]
    number = getattr(ParameterType, f"PARAMETER_{name.upper()}")
    return ParameterValue(type=number, **{f"{name}_value": list(value) if isinstance(value, tuple) else value})


def from_parameter_value(value: ParameterValue) -> Any:
    """Return a parameter value as a Python value; None if it is not set, or of a type that does not exist."""
    with contextlib.suppress(RuntimeError):
        return parameter_value_to_python(value)
    return None
