"""`ros2 action`: list, info, type and send_goal."""

from __future__ import annotations

import uuid
from typing import TYPE_CHECKING, Any

import click

from ros_in_python.ros2 import interfaces
from ros_in_python.ros2.cli import CommandError, Menu, StopSignal, held_back, show_names, stdin_option
from ros_in_python.ros2.names import absolute
from ros_in_python.ros2.opening import with_graph
from ros_in_python.ros2.typed_names import existing, show, show_types_option

if TYPE_CHECKING:
    from ros_in_python.ros2.graph import GraphView

action = Menu(
    name="action",
    help="""List actions, send a goal to one.

    \b
      ros2 action list -t
      ros2 action send_goal --feedback /fibonacci test_msgs/action/Fibonacci '{order: 5}'
    """,
)

#: Seconds that a goal gets to be cancelled in after Ctrl-C.
CANCELLING = 2.0


@action.command(name="list")
@show_types_option
@click.option("-c", "--count-actions", "only_count", is_flag=True, help="Print only the number.")
@with_graph
def list_(graph: GraphView, show_types: bool, only_count: bool) -> None:
    """All actions.

    \b
      ros2 action list -t
      /fibonacci [test_msgs/action/Fibonacci]
    """
    graph.settle()
    show(graph.actions(), show_types=show_types, only_count=only_count)


@action.command(name="type")
@click.argument("action_name")
@with_graph
def type_(graph: GraphView, action_name: str) -> None:
    """The type of an action.

    \b
      ros2 action type /fibonacci
    """
    show_names(existing(graph, graph.actions, "action", action_name).types, only_count=False)


@action.command()
@click.argument("action_name")
@click.option("-t", "--show-types", is_flag=True, help="Show the type each node uses too.")
@click.option("-c", "--count", is_flag=True, help="Print only the number.")
@with_graph
def info(graph: GraphView, action_name: str, show_types: bool, count: bool) -> None:
    """The clients and servers of an action.

    \b
      ros2 action info /fibonacci
    """
    from rclpy.action import get_action_client_names_and_types_by_node, get_action_server_names_and_types_by_node

    name = absolute(action_name, "action")
    graph.settle(lambda: any(each.name == name for each in graph.actions()))
    ends = {
        "clients": _nodes_with(graph, name, get_action_client_names_and_types_by_node),
        "servers": _nodes_with(graph, name, get_action_server_names_and_types_by_node),
    }
    click.echo(f"Action: {action_name}")
    for role, nodes in ends.items():
        click.echo(f"Action {role}: {len(nodes)}")
        for node_name, types in [] if count else nodes:
            click.echo(f"    {node_name} [{', '.join(types)}]" if show_types else f"    {node_name}")


@action.command(name="send_goal")
@click.argument("action_name")
@click.argument("action_type")
@click.argument("goal", default="{}")
@stdin_option("goal")
@click.option("-f", "--feedback", is_flag=True, help="Print the feedback on the way.")
@with_graph
def send_goal(graph: GraphView, action_name: str, action_type: str, goal: str, feedback: bool) -> None:
    """Send a goal given in YAML and print its result; Ctrl-C cancels it.

    \b
      ros2 action send_goal --feedback /fibonacci test_msgs/action/Fibonacci '{order: 5}'
    """
    from rclpy.action import ActionClient

    from ros_in_python.ros2.messages import fill, read_values, to_yaml

    kind = interfaces.action_class(action_type)
    message = kind.Goal()
    fill(message, read_values(goal, "goal"))
    name = absolute(action_name, "action")
    news = _News()
    if feedback:
        # The client's own call-back for feedback is dropped as soon as the result has come, with what is under way.
        graph.node.create_subscription(kind.Impl.FeedbackMessage, f"{name}/_action/feedback", news.on_feedback, 10)
    client = ActionClient(graph.node, kind, name)
    print("Waiting for an action server to become available...", flush=True)
    _wait_for_server(graph, client, name, interfaces.full_name(action_type, "action"))
    print(f"Sending goal:\n     {to_yaml(message)}", flush=True)

    sent = client.send_goal_async(message, goal_uuid=news.goal_id)
    try:
        handle = _done(graph, sent, "sending goal")
        if not handle.accepted:
            print("Goal was rejected.", flush=True)
            return
        print(f"Goal accepted with ID: {bytes(handle.goal_id.uuid).hex()}\n", flush=True)
        news.print_from_now_on()
        with held_back():
            result = handle.get_result_async()
        answer = _done(graph, result, "getting result")
        graph.spin_arrived()
    except StopSignal:
        _cancel(graph, sent)
        raise
    print(f"Result:\n    {to_yaml(answer.result)}", flush=True)
    print(f"Goal finished with status: {_status(answer.status)}", flush=True)


class _News:
    """The feedback on a goal, printed in its place: after the goal's acceptance and before its result.

    Feedback comes by a topic, acceptance and result by services, and what arrives together is handled in no order.
    """

    def __init__(self) -> None:
        from unique_identifier_msgs.msg import UUID

        self.goal_id = UUID(uuid=list(uuid.uuid4().bytes))
        self._held: list[Any] | None = []

    def on_feedback(self, message: Any) -> None:
        """Handle a feedback message of the action, of any goal."""
        if message.goal_id != self.goal_id:
            return
        if self._held is None:
            _print_feedback(message)
        else:
            self._held.append(message)

    def print_from_now_on(self) -> None:
        """Print feedback from now on, and what has arrived before: the acceptance has been printed."""
        held, self._held = self._held or [], None
        for message in held:
            _print_feedback(message)


def _print_feedback(message: Any) -> None:
    from ros_in_python.ros2.messages import to_yaml

    print(f"Feedback:\n    {to_yaml(message.feedback)}", flush=True)


def _wait_for_server(graph: GraphView, client: Any, name: str, type_name: str) -> None:
    """Wait for the server, without a limit. Raises `CommandError` if it has another type."""
    from rclpy.action import get_action_server_names_and_types_by_node

    def ready_or_never() -> bool:
        if client.server_is_ready():
            return True
        others = [kind for each in graph.actions() if each.name == name for kind in each.types if kind != type_name]
        if others:
            raise CommandError(f"The action '{name}' is of type {' or '.join(others)}, not {type_name}.")
        return False

    graph.spin_until(ready_or_never)
    for server, _ in _nodes_with(graph, name, get_action_server_names_and_types_by_node):
        graph.wait_until_known(server)


def _done(graph: GraphView, future: Any, doing: str) -> Any:
    graph.spin_until(future.done)
    if future.exception() is not None:
        raise CommandError(f"Exception while {doing}: {future.exception()!r}")
    return future.result()


def _cancel(graph: GraphView, sent: Any) -> None:
    """Cancel the goal that was sent, even if it has not been accepted yet."""
    if not graph.spin_until(sent.done, CANCELLING) or not sent.result().accepted:
        return
    print("Canceling goal...", flush=True)
    future = sent.result().cancel_goal_async()
    if graph.spin_until(future.done, CANCELLING) and future.result().goals_canceling:
        print("Goal canceled.", flush=True)
    else:
        click.echo("Failed to cancel goal", err=True)


def _status(number: int) -> str:
    from action_msgs.msg import GoalStatus

    names = ("ACCEPTED", "EXECUTING", "CANCELING", "SUCCEEDED", "CANCELED", "ABORTED")
    return next((name for name in names if getattr(GoalStatus, f"STATUS_{name}") == number), "UNKNOWN")


def _nodes_with(graph: GraphView, action_name: str, ask: Any) -> list[tuple[str, list[str]]]:
    """Return the nodes that have an end of an action, with its types, as `ask` finds them."""
    return sorted(
        (node.full_name, types)
        for node in graph.nodes()
        for name, types in ask(graph.node, node.name, node.namespace)
        if name == action_name
    )
