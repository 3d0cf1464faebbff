"""The service ~/get_type_description of every node (REP 2016)."""

from __future__ import annotations

from typing import Any

from rcl_python.endpoints import Service
from rcl_python.handle import Destroyable
from rcl_python.node import Node
from rcl_python.qos import Profile


class TypeDescriptionService(Destroyable):
    """Answers with a type's description, if the interface packages' descriptions are installed."""

    def __init__(self, node: Node) -> None:
        super().__init__()
        from type_description_interfaces.srv import GetTypeDescription

        self._service = Service(node, GetTypeDescription, "~/get_type_description", Profile())

    def _destroy(self) -> None:
        self._service.destroy_when_not_in_use()

    @property
    def impl(self) -> Service:
        """The service itself."""
        return self._service

    def handle_request(self, request: Any, response_class: Any, node: Node) -> Any:
        """Answer that the description is not known: types are known by their Python classes alone."""
        response = response_class()
        response.successful = False
        response.failure_reason = "Type descriptions are not available."
        return response
