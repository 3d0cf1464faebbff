"""`ros2 topic pub`."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

import click

from ros_in_python.ros2 import interfaces
from ros_in_python.ros2.cli import CommandError, discovery_options, stdin_option
from ros_in_python.ros2.names import absolute
from ros_in_python.ros2.opening import open_graph
from ros_in_python.ros2.qos import QosOptions, profile, qos_options

if TYPE_CHECKING:
    from ros_in_python.ros2.graph import GraphView

#: Seconds between two lines that say what the command is waiting for.
REPORT_EVERY_S = 1.0
#: Seconds that a reliable subscription gets to confirm the last message.
CONFIRMATION = 2.0


@click.command()
@click.argument("topic_name")
@click.argument("message_type")
@click.argument("values", default="{}")
@stdin_option("values")
@click.option("-1", "--once", is_flag=True, help="Publish one message and exit.")
@click.option("-t", "--times", type=click.IntRange(min=0), default=0, help="Publish this many messages and exit.")
@click.option(
    "-r",
    "--rate",
    type=click.FloatRange(min=0, min_open=True),
    default=1.0,
    show_default=True,
    metavar="N",
    help="Messages per second.",
)
@click.option("-p", "--print", "print_nth", type=int, default=1, metavar="N", help="Print every N-th message only.")
@click.option(
    "-w",
    "--wait-matching-subscriptions",
    type=click.IntRange(min=0),
    metavar="N",
    help="Begin when N subscriptions match (1 with --once and --times, else 0).",
)
@click.option("--max-wait-time-secs", type=float, metavar="N", help="Wait for them N seconds at most.")
@click.option(
    "--keep-alive", type=float, default=0.1, show_default=True, metavar="N", help="Stay N seconds after the last."
)
@click.option("-n", "--node-name", metavar="NAME", help="The publishing node's name.")
@qos_options("default")
@discovery_options
def pub(topic_name: str, message_type: str, values: str, qos: QosOptions, **options: Any) -> None:
    """Publish messages whose fields are given in YAML; fields not named are zero or empty.

    \b
      ros2 topic pub --once /turtle1/cmd_vel geometry_msgs/msg/Twist '{linear: {x: 2.0}, angular: {z: 1.0}}'
      ros2 topic pub --rate 10 /joint_commands sensor_msgs/msg/JointState \\
          '{header: auto, name: [left_elbow], position: [0.5]}'

    `header: auto` stamps each message with the time at which it is published; `now` does so for a single time.
    """
    if options["once"] and options["times"]:
        raise CommandError("Cannot pass both -1 and -t <times>")
    with open_graph(
        node_name=options["node_name"], spin_time=options["spin_time"], use_sim_time=options["use_sim_time"]
    ) as graph:
        from ros_in_python.ros2.messages import fill, read_values

        kind = interfaces.message_class(message_type)
        message = kind()
        # Before anything is published or waited for: a typing error should show at once.
        setters = fill(message, read_values(values, "value"), stamps=True)
        topic = absolute(topic_name)
        times = 1 if options["once"] else options["times"]
        wait_for = options["wait_matching_subscriptions"]
        if wait_for is None:
            wait_for = 1 if times else 0
        # Existing subscribers must get the first message.
        graph.settle(lambda: len(graph.subscriptions(topic)) >= wait_for)
        publisher = graph.node.create_publisher(kind, topic, profile(qos))
        _wait_for_subscriptions(graph, publisher, wait_for, options["max_wait_time_secs"])
        _publish(graph, publisher, message, setters, times, options)


def _wait_for_subscriptions(graph: GraphView, publisher: Any, count: int, most: float | None) -> None:
    start = time.monotonic()
    while publisher.get_subscription_count() < count:
        print(f"Waiting for at least {count} matching subscription(s)...", flush=True)
        left = None if most is None else most - (time.monotonic() - start)
        timeout = REPORT_EVERY_S if left is None else min(REPORT_EVERY_S, left)
        if graph.spin_until(lambda: publisher.get_subscription_count() >= count, timeout):
            return
        if left is not None and left <= REPORT_EVERY_S:
            raise CommandError(
                f"Timed out waiting for subscribers: Expected {count} subscribers but only got "
                f"{publisher.get_subscription_count()} subscribers",
                "A subscription of another type or of an incompatible QoS does not match: see ros2 topic info -v.",
            )


def _publish(
    graph: GraphView, publisher: Any, message: Any, setters: list[Any], times: int, options: dict[str, Any]
) -> None:
    from rclpy.duration import Duration

    count = 0

    def publish() -> None:
        nonlocal count
        now = graph.node.get_clock().now().to_msg()
        for set_stamp in setters:
            set_stamp(now)
        count += 1
        if options["print_nth"] and count % options["print_nth"] == 0:
            print(f"publishing #{count}: {message!r}\n", flush=True)
        publisher.publish(message)

    print("publisher: beginning loop", flush=True)
    publish()
    if times != 1:
        graph.node.create_timer(1 / options["rate"], publish)
        graph.spin_until(lambda: times != 0 and count >= times)
    publisher.wait_for_all_acked(Duration(seconds=CONFIRMATION))
    time.sleep(options["keep_alive"])
