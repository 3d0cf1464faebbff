"""What our own node sees of the others: nodes, topics, services and their names."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from types import TracebackType
from typing import Any

import rclpy
from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor, TimeoutException
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.signals import SignalHandlerOptions
from rclpy.topic_endpoint_info import TopicEndpointInfo
from rclpy.topic_or_service_is_hidden import topic_or_service_is_hidden

from ros_in_python.ros2.cli import CommandError, held_back
from ros_in_python.ros2.domain import domain_id, hears_other_hosts, participants

# Each call of the command starts its own node, so discovery has to finish before it answers. The graph, not the clock,
# decides when that is: see `GraphView.settle`.


#: Seconds between two looks at the graph; and the most between a signal and its effect.
LOOK, NAP = 0.02, 0.1
#: Seconds without a change after which the graph counts as known.
QUIET = 0.25
#: Seconds to discover nodes on other hosts, the same as the real command's.
OTHER_HOSTS = 0.5
#: Seconds until the answer may be "there is no such thing".
ABSENT = 1.0
#: Seconds after which an answer is given in any case.
DEADLINE = 4.0

#: Seconds between two questions to a node whether it knows us, and until we give up: it may have no parameter services,
#: or be busy in a callback.
ASK_AGAIN, KNOWN = 0.2, 3.0

# On this DDS topic, each ROS participant says which node owns which endpoint (package rmw_dds_common).
_PARTICIPANTS = "ros_discovery_info"
# The owner of an endpoint according to rmw_dds_common, until then.
_NAMELESS = "_NODE_NAME_UNKNOWN_"
_GID_PREFIX = 12


@dataclass(frozen=True, order=True)
class NodeName:
    """A running node."""

    full_name: str
    name: str
    namespace: str

    @property
    def hidden(self) -> bool:
        """Whether the node is not to be listed: its name, or a part of its namespace, begins with an underscore."""
        return topic_or_service_is_hidden(self.full_name)


@dataclass(frozen=True, order=True)
class TypedName:
    """A topic, service or action, and its types (more than one where its ends disagree)."""

    name: str
    types: tuple[str, ...]

    @property
    def hidden(self) -> bool:
        """Whether it is not to be listed: a part of its name begins with an underscore."""
        return topic_or_service_is_hidden(self.name)

    def __str__(self) -> str:
        return f"{self.name} [{', '.join(self.types)}]"


class GraphView:
    """A hidden node with a context and an executor of its own; a context manager.

    `spin_time` is how long discovery may take, in seconds, whatever it has found by then.
    """

    def __init__(self, *, node_name: str | None, spin_time: float | None, use_sim_time: bool) -> None:
        self.context = Context()
        try:
            # Signals are ours: see cli.py.
            rclpy.init(args=[], context=self.context, signal_handler_options=SignalHandlerOptions.NO)
        except RuntimeError as error:
            raise CommandError(f"ROS 2 could not start: {str(error).splitlines()[0]}") from None
        self.node = Node(
            node_name or f"_ros2cli_{os.getpid()}",
            context=self.context,
            use_global_arguments=False,
            enable_rosout=False,
            start_parameter_services=False,
            parameter_overrides=[
                Parameter("start_type_description_service", Parameter.Type.BOOL, False),
                Parameter("use_sim_time", Parameter.Type.BOOL, use_sim_time),
            ],
        )
        self.executor = SingleThreadedExecutor(context=self.context)
        self.executor.add_node(self.node)
        self._born = time.monotonic()
        self._spin_time = spin_time

    def __enter__(self) -> GraphView:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.executor.shutdown(timeout_sec=0)
        self.node.destroy_node()
        rclpy.try_shutdown(context=self.context)

    # What is there

    def nodes(self) -> list[NodeName]:
        """Return every node except ours, by full name; two with the same name are listed twice."""
        own = self.node.get_name()
        return sorted(
            NodeName(f"{namespace.rstrip('/')}/{name}", name, namespace)
            for name, namespace in self.node.get_node_names_and_namespaces()
            if name != own
        )

    def node_names(self, include_hidden: bool) -> list[str]:
        """Return the full names of `nodes`, of hidden ones only with `include_hidden`."""
        return [node.full_name for node in self.nodes() if include_hidden or not node.hidden]

    def topics(self) -> list[TypedName]:
        """Return every topic that another node publishes or subscribes to, including hidden ones."""
        return [
            TypedName(name, tuple(types))
            for name, types in self.node.get_topic_names_and_types()
            if self.publishers(name) or self.subscriptions(name)
        ]

    def topic_types(self, name: str) -> tuple[str, ...]:
        """Return the types of a topic by its full name; none if there is no such topic."""
        return next((topic.types for topic in self.topics() if topic.name == name), ())

    def publishers(self, topic: str) -> list[TopicEndpointInfo]:
        """Return the publishers on a topic, except ours."""
        return self._others(self.node.get_publishers_info_by_topic(topic))

    def subscriptions(self, topic: str) -> list[TopicEndpointInfo]:
        """Return the subscriptions on a topic, except ours."""
        return self._others(self.node.get_subscriptions_info_by_topic(topic))

    def services(self) -> list[TypedName]:
        """Return every service, including hidden ones."""
        return [TypedName(name, tuple(types)) for name, types in self.node.get_service_names_and_types()]

    def actions(self) -> list[TypedName]:
        """Return every action, including hidden ones."""
        from rclpy.action import get_action_names_and_types  # with numpy: half a start of `ros2`, for actions alone

        return [TypedName(name, tuple(types)) for name, types in get_action_names_and_types(self.node)]

    def _others(self, ends: Iterable[TopicEndpointInfo]) -> list[TopicEndpointInfo]:
        own = self.node.get_name()
        return [end for end in ends if end.node_name != own]

    # Waiting

    def settle(self, condition: Callable[[], bool] | None = None) -> None:
        """Return when the graph is known: every participant on this host has been found, every endpoint has a node, and
        nothing has changed for a while.

        With `condition`, wait until that holds, too, or until `ABSENT` seconds have passed.
        """
        deadline = self._born + (self._spin_time or DEADLINE)
        seen, changed = self._look(), time.monotonic()
        while time.monotonic() < deadline:
            time.sleep(LOOK)
            now = time.monotonic()
            look = self._look()
            if look != seen:
                seen, changed = look, now
            if now - changed < QUIET or not self._complete():
                continue
            nothing = not self.nodes() or (condition is not None and not condition())
            if now - self._born >= self._shortest(nothing):
                return

    def _shortest(self, nothing: bool) -> float:
        if nothing:
            return ABSENT
        return OTHER_HOSTS if hears_other_hosts() else 0.0

    def _look(self) -> tuple[Any, ...]:
        node = self.node
        topics = node.get_topic_names_and_types()
        ends = [(node.count_publishers(name), node.count_subscribers(name)) for name, _ in topics]
        return topics, ends, node.get_service_names_and_types(), self.nodes()

    def _complete(self) -> bool:
        """Return whether no participant is missing and none is without a node."""
        heard = self._heard()
        here = participants(domain_id())
        if here is not None and len(heard) < here:
            return False
        ends = [
            end
            for name, _ in self.node.get_topic_names_and_types()
            for end in (*self.node.get_publishers_info_by_topic(name), *self.node.get_subscriptions_info_by_topic(name))
        ]
        with_node = {bytes(end.endpoint_gid[:_GID_PREFIX]) for end in ends if end.node_name != _NAMELESS}
        return heard <= with_node and all(end.node_name != _NAMELESS for end in ends)

    def _heard(self) -> set[bytes]:
        """Return the participants that have been found, including ours, until they say that they leave."""
        writers = self.node.get_publishers_info_by_topic(_PARTICIPANTS, no_mangle=True)
        return {bytes(end.endpoint_gid[:_GID_PREFIX]) for end in writers}

    # Working

    def spin_once(self) -> None:
        """Handle what has arrived, or wait a moment for it. A signal is raised after that: see cli.py."""
        with held_back():
            self.executor.spin_once(timeout_sec=NAP)

    def spin_arrived(self) -> None:
        """Handle everything that has arrived, without waiting."""
        with held_back():
            while self._handle_ready():
                pass

    def _handle_ready(self) -> bool:
        """Handle one message of each endpoint that has any; return whether there were any."""
        some = False
        while True:
            try:
                handler, _, _ = self.executor.wait_for_ready_callbacks(timeout_sec=0)
            except TimeoutException:
                return some
            some = True
            handler()
            if handler.exception() is not None:
                raise handler.exception()

    def wait_until_known(self, node_name: str) -> None:
        """Return when a node has discovered every client that was created here so far, or after `KNOWN` seconds.

        A server drops the answer to a client that it has not discovered, and a client can see that it has found
        its server but not the reverse. Endpoints are announced in the order of their creation, so the answer to a
        client created last proves that the others are known. The question, for the node's parameter names, has no
        effect and is asked again until it is answered.
        """
        from rcl_interfaces.srv import ListParameters

        client = self.node.create_client(ListParameters, f"{node_name}/list_parameters")
        asked: list[Any] = []
        end = time.monotonic() + KNOWN
        while time.monotonic() < end:
            if client.service_is_ready():
                asked.append(client.call_async(ListParameters.Request()))
            if self.spin_until(lambda: any(future.done() for future in asked), ASK_AGAIN):
                break
        self.node.destroy_client(client)

    def spin_until(self, done: Callable[[], bool], deadline: float | None = None) -> bool:
        """Handle what arrives until `done()`, at most `deadline` seconds; return whether it is done."""
        end = None if deadline is None else time.monotonic() + deadline
        while not done():
            if end is not None and time.monotonic() >= end:
                return False
            self.spin_once()
        return True
