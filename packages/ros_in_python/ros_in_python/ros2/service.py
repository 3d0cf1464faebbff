"""`ros2 service`: list, type, find, info, call and echo."""

from __future__ import annotations

import difflib
import sys
import time
from typing import TYPE_CHECKING, Any

import click

from ros_in_python.ros2 import interfaces
from ros_in_python.ros2.cli import CONTEXT, CommandError, Menu, MenuEntry, discovery_options
from ros_in_python.ros2.opening import open_graph
from ros_in_python.ros2.topic.selection import reading_options

if TYPE_CHECKING:
    from ros_in_python.ros2.graph import GraphView, TypedName

service = Menu(
    name="service",
    entries={
        "call": MenuEntry("ros_in_python.ros2.service:call", "Call a service and print its answer."),
        "echo": MenuEntry("ros_in_python.ros2.service:echo", "Print the requests and answers of a service."),
        "find": MenuEntry("ros_in_python.ros2.service:find", "The services of a type."),
        "info": MenuEntry("ros_in_python.ros2.service:info", "How many clients and servers a service has."),
        "list": MenuEntry("ros_in_python.ros2.service:list_", "All services."),
        "type": MenuEntry("ros_in_python.ros2.service:type_", "The type of a service."),
    },
    help="""List services, call one.

    \b
      ros2 service list -t
      ros2 service call /stand_up std_srvs/srv/SetBool '{data: true}'
    """,
)


@click.command(name="list", context_settings=CONTEXT)
@click.option("-t", "--show-types", is_flag=True, help="Show each service's type too.")
@click.option("-c", "--count-services", is_flag=True, help="Print only the number.")
@click.option("-a", "--include-hidden-services", is_flag=True, help="Hidden ones too.")
@discovery_options
def list_(
    show_types: bool, count_services: bool, include_hidden_services: bool, spin_time: float | None, use_sim_time: bool
) -> None:
    """All services.

    \b
      ros2 service list -t
    """
    with open_graph(spin_time=spin_time, use_sim_time=use_sim_time) as graph:
        graph.settle()
        services = _visible(graph, include_hidden_services)
    if count_services:
        click.echo(str(len(services)))
        return
    for found in services:
        click.echo(str(found) if show_types else found.name)


@click.command(name="type", context_settings=CONTEXT)
@click.argument("service_name")
@discovery_options
def type_(service_name: str, spin_time: float | None, use_sim_time: bool) -> None:
    """The type of a service.

    \b
      ros2 service type /joint_monitor/get_parameters
    """
    with open_graph(spin_time=spin_time, use_sim_time=use_sim_time) as graph:
        found = _wanted(graph, service_name)
    for kind in found.types:
        click.echo(kind)


@click.command(context_settings=CONTEXT)
@click.argument("service_type")
@click.option("-c", "--count-services", is_flag=True, help="Print only the number.")
@click.option("-a", "--include-hidden-services", is_flag=True, help="Hidden ones too.")
@discovery_options
def find(
    service_type: str, count_services: bool, include_hidden_services: bool, spin_time: float | None, use_sim_time: bool
) -> None:
    """The services of a type.

    \b
      ros2 service find std_srvs/srv/Trigger
    """
    wanted = interfaces.full_name(service_type, "srv")
    with open_graph(spin_time=spin_time, use_sim_time=use_sim_time) as graph:
        graph.settle(lambda: any(wanted in found.types for found in graph.services()))
        names = [found.name for found in _visible(graph, include_hidden_services) if wanted in found.types]
    for line in [str(len(names))] if count_services else names:
        click.echo(line)


@click.command(context_settings=CONTEXT)
@click.argument("service_name")
@discovery_options
def info(service_name: str, spin_time: float | None, use_sim_time: bool) -> None:
    """How many clients and servers a service has.

    \b
      ros2 service info /stand_up
    """
    with open_graph(spin_time=spin_time, use_sim_time=use_sim_time) as graph:
        found = _wanted(graph, service_name)
        clients, servers = graph.node.count_clients(found.name), graph.node.count_services(found.name)
    click.echo(f"Type: {found.types[0] if len(found.types) == 1 else list(found.types)}")
    click.echo(f"Clients count: {clients}")
    click.echo(f"Services count: {servers}")


@click.command(context_settings=CONTEXT)
@click.argument("service_name")
@click.argument("service_type")
@click.argument("values", default="{}")
@click.option(
    "-r", "--rate", type=click.FloatRange(min=0, min_open=True), metavar="N", help="Repeat N times per second."
)
@discovery_options
def call(
    service_name: str, service_type: str, values: str, rate: float | None, spin_time: float | None, use_sim_time: bool
) -> None:
    """Call a service with a request given in YAML, and print its answer.

    \b
      ros2 service call /stand_up std_srvs/srv/SetBool '{data: true}'
    """
    with open_graph(spin_time=spin_time, use_sim_time=use_sim_time) as graph:
        from ros_in_python.ros2.graph import absolute
        from ros_in_python.ros2.messages import fill, read_values

        kind = interfaces.service_class(service_type)
        request = kind.Request()
        fill(request, read_values(values, "request"))
        name = absolute(service_name, "service")
        client = graph.node.create_client(kind, name)
        _wait_until_ready(graph, client, name, interfaces.full_name(service_type, "srv"))
        while True:
            _ask(graph, client, request, None if rate is None else 1 / rate)
            if rate is None:
                return


def _ask(graph: GraphView, client: Any, request: Any, period: float | None) -> None:
    """Make one request and print the answer; with a `period` (s), return when the next one is due."""
    print(f"requester: making request: {request!r}\n", flush=True)
    start = time.monotonic()
    future = client.call_async(request)
    graph.spin_until(future.done)
    if future.exception() is not None:
        raise CommandError(f"Exception while calling service: {future.exception()!r}")
    print(f"response:\n{future.result()!r}\n", flush=True)
    if period is not None:
        graph.spin_until(lambda: False, max(0.0, start + period - time.monotonic()))


def _wait_until_ready(graph: GraphView, client: Any, name: str, wanted: str) -> None:
    """Wait for the service, without a limit. Raises `CommandError` if it has another type."""
    if not client.service_is_ready():
        print("waiting for service to become available...", flush=True)
        graph.settle(client.service_is_ready)
        if not client.service_is_ready() and (alike := _alike(graph, name)):
            print(f"There is no service '{name}' yet. Did you mean {alike}? Ctrl-C ends the wait.", file=sys.stderr)

    def ready_or_never() -> bool:
        types = next((found.types for found in graph.services() if found.name == name), (wanted,))
        # The client of this call is in the graph with its own type.
        others = [kind for kind in types if kind != wanted]
        if others and not client.service_is_ready() and graph.node.count_services(name):
            raise CommandError(
                f"The service '{name}' is of type {' or '.join(others)}, not {wanted}.",
                f"ros2 service call {name} {others[0]}",
            )
        return bool(client.service_is_ready())

    graph.spin_until(ready_or_never)
    for node in graph.nodes():
        if name in dict(graph.node.get_service_names_and_types_by_node(node.name, node.namespace)):
            graph.wait_until_known(node.full_name)


def _alike(graph: GraphView, name: str) -> str:
    """Return the services whose names are similar to `name`, joined by 'or'; empty if there are none."""
    names = [found.name for found in graph.services() if found.name != name]
    return " or ".join(difflib.get_close_matches(name, names, n=2, cutoff=0.75))


def _visible(graph: GraphView, include_hidden: bool) -> list[TypedName]:
    from rclpy.topic_or_service_is_hidden import topic_or_service_is_hidden

    return [found for found in graph.services() if include_hidden or not topic_or_service_is_hidden(found.name)]


def _wanted(graph: GraphView, service_name: str) -> TypedName:
    """Return the service of this name. Raises `CommandError`, with those that there are, if it does not exist."""
    from ros_in_python.ros2.graph import absolute, seen

    name = absolute(service_name, "service")
    graph.settle(lambda: any(found.name == name for found in graph.services()))
    for found in graph.services():
        if found.name == name:
            return found
    raise CommandError(
        f"Unknown service '{service_name}'", seen("Services", (found.name for found in _visible(graph, False)))
    )


@click.command(context_settings=CONTEXT)
@click.argument("service_name")
@click.argument("service_type", required=False)
@reading_options
@discovery_options
def echo(service_name: str, service_type: str | None, **options: Any) -> None:
    """Print the requests and answers of a service, whose node has to publish them: configure_introspection().

    \b
      ros2 service echo /stand_up
    """
    with open_graph(spin_time=options.pop("spin_time"), use_sim_time=options.pop("use_sim_time")) as graph:
        from rclpy.qos import qos_profile_services_default

        from ros_in_python.ros2.graph import absolute
        from ros_in_python.ros2.topic.echo import listen

        name = absolute(service_name, "service")
        if service_type is None:
            service_type = _wanted(graph, service_name).types[0]
        topic, kind = f"{name}/_service_event", interfaces.service_class(service_type)
        graph.settle(lambda: bool(graph.publishers(topic)))
        if not graph.publishers(topic):
            click.echo(
                f"No node publishes the calls of {name} yet: see Node.configure_introspection in rclpy.", err=True
            )
        listen(graph, topic, kind.Event, (), qos_profile_services_default, options)
