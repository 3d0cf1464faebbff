"""`ros2 service`: list, type, find, info, call and echo."""

from __future__ import annotations

import difflib
import sys
import time
from typing import TYPE_CHECKING, Any

import click

from ros_in_python.ros2 import interfaces
from ros_in_python.ros2.cli import CommandError, Menu, show_names, stdin_option
from ros_in_python.ros2.names import absolute
from ros_in_python.ros2.opening import with_graph
from ros_in_python.ros2.topic.selection import reading_options
from ros_in_python.ros2.typed_names import existing, listing_options, show, show_of_type, show_types_option

if TYPE_CHECKING:
    from ros_in_python.ros2.graph import GraphView

service = Menu(
    name="service",
    help="""List services, call one.

    \b
      ros2 service list -t
      ros2 service call /stand_up std_srvs/srv/SetBool '{data: true}'
    """,
)


@service.command(name="list")
@show_types_option
@listing_options("service")
@with_graph
def list_(graph: GraphView, show_types: bool, only_count: bool, include_hidden: bool) -> None:
    """All services.

    \b
      ros2 service list -t
    """
    graph.settle()
    show(graph.services(), show_types=show_types, only_count=only_count, include_hidden=include_hidden)


@service.command(name="type")
@click.argument("service_name")
@with_graph
def type_(graph: GraphView, service_name: str) -> None:
    """The type of a service.

    \b
      ros2 service type /joint_monitor/get_parameters
    """
    show_names(existing(graph, graph.services, "service", service_name).types, only_count=False)


@service.command()
@click.argument("service_type")
@listing_options("service")
@with_graph
def find(graph: GraphView, service_type: str, only_count: bool, include_hidden: bool) -> None:
    """The services of a type.

    \b
      ros2 service find std_srvs/srv/Trigger
    """
    show_of_type(graph, graph.services, interfaces.full_name(service_type, "srv"), only_count, include_hidden)


@service.command()
@click.argument("service_name")
@with_graph
def info(graph: GraphView, service_name: str) -> None:
    """How many clients and servers a service has.

    \b
      ros2 service info /stand_up
    """
    about = existing(graph, graph.services, "service", service_name)
    clients, servers = graph.node.count_clients(about.name), graph.node.count_services(about.name)
    click.echo(f"Type: {about.types[0] if len(about.types) == 1 else list(about.types)}")
    click.echo(f"Clients count: {clients}")
    click.echo(f"Services count: {servers}")


@service.command()
@click.argument("service_name")
@click.argument("service_type")
@click.argument("values", default="{}")
@stdin_option("values")
@click.option(
    "-r", "--rate", type=click.FloatRange(min=0, min_open=True), metavar="N", help="Repeat N times per second."
)
@with_graph
def call(graph: GraphView, service_name: str, service_type: str, values: str, rate: float | None) -> None:
    """Call a service with a request given in YAML, and print its answer.

    \b
      ros2 service call /stand_up std_srvs/srv/SetBool '{data: true}'
    """
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


def _wait_until_ready(graph: GraphView, client: Any, name: str, type_name: str) -> None:
    """Wait for the service, without a limit. Raises `CommandError` if it has another type."""
    if not client.service_is_ready():
        graph.settle(client.service_is_ready)  # one that runs may only not have been discovered yet
    if not client.service_is_ready():
        print("waiting for service to become available...", flush=True)
        if alike := _alike(graph, name):
            print(f"There is no service '{name}' yet. Did you mean {alike}? Ctrl-C ends the wait.", file=sys.stderr)

    def ready_or_never() -> bool:
        types = next((each.types for each in graph.services() if each.name == name), (type_name,))
        # The client of this call is in the graph with its own type.
        others = [kind for kind in types if kind != type_name]
        if others and not client.service_is_ready() and graph.node.count_services(name):
            raise CommandError(
                f"The service '{name}' is of type {' or '.join(others)}, not {type_name}.",
                f"ros2 service call {name} {others[0]}",
            )
        return bool(client.service_is_ready())

    graph.spin_until(ready_or_never)
    for node in graph.nodes():
        if name in dict(graph.node.get_service_names_and_types_by_node(node.name, node.namespace)):
            graph.wait_until_known(node.full_name)


def _alike(graph: GraphView, name: str) -> str:
    """Return the services whose names are similar to `name`, joined by 'or'; empty if there are none."""
    names = [other.name for other in graph.services() if other.name != name]
    return " or ".join(difflib.get_close_matches(name, names, n=2, cutoff=0.75))


@service.command()
@click.argument("service_name")
@click.argument("service_type", required=False)
@reading_options
@with_graph
def echo(graph: GraphView, service_name: str, service_type: str | None, **options: Any) -> None:
    """Print the requests and answers of a service, whose node has to publish them: configure_introspection().

    \b
      ros2 service echo /stand_up
    """
    from rclpy.qos import qos_profile_services_default

    from ros_in_python.ros2.topic.echo import listen

    name = absolute(service_name, "service")
    if service_type is None:
        service_type = existing(graph, graph.services, "service", service_name).types[0]
    topic, kind = f"{name}/_service_event", interfaces.service_class(service_type)
    graph.settle(lambda: bool(graph.publishers(topic)))
    if not graph.publishers(topic):
        click.echo(f"No publishers on topic '{topic}'; is service introspection on the client or server enabled?")
        click.echo("In rclpy, it is with configure_introspection of the service or the client.", err=True)
    listen(graph, topic, kind.Event, (), qos_profile_services_default, options)
