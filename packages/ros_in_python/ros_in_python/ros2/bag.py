"""`ros2 bag`: record, play and info, over bags in MCAP, which Foxglove and PlotJuggler open, and in sqlite3."""

from __future__ import annotations

import time
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ros_in_python.ros2 import cli, interfaces
from ros_in_python.ros2.bag_storage import duration_of, know_type, message_types, reading, stored_files, writing
from ros_in_python.ros2.cli import CommandError, Menu
from ros_in_python.ros2.names import absolute
from ros_in_python.ros2.opening import open_graph

if TYPE_CHECKING:
    from ros_in_python.ros2.graph import GraphView

SECOND = 1_000_000_000

#: Seconds between two looks for new topics.
LOOK_AGAIN = 0.5

bag = Menu(
    name="bag",
    help="""Record topics into a file, and play them again.

    \b
      ros2 bag record -o swing /joint_commands
      ros2 bag info swing
      ros2 bag play swing
    """,
)


@bag.command()
@click.argument("topics", nargs=-1)
@click.option("-a", "--all", "all_topics", is_flag=True, help="Record every topic.")
@click.option("-o", "--output", type=click.Path(path_type=Path), help="The bag's folder.  [default: rosbag2_DATE]")
@click.option("-s", "--storage", type=click.Choice(["mcap", "sqlite3"]), default="mcap", help="How it is stored.")
@click.option("--use-sim-time", is_flag=True, help="Take the time from /clock.")
def record(topics: tuple[str, ...], all_topics: bool, output: Path | None, storage: str, use_sim_time: bool) -> None:
    """Write messages into a bag until Ctrl-C.

    \b
      ros2 bag record /joint_commands /joint_velocities
      ros2 bag record -a -o everything
    """
    if bool(topics) == all_topics:
        raise CommandError("Invalid choice: Must specify only one option out of: topics or --all")
    folder = output or Path(datetime.now().strftime("rosbag2_%Y_%m_%d-%H_%M_%S"))
    if folder.exists():
        raise CommandError(f"[ERROR] [ros2bag]: Output folder '{folder}' already exists.", "Name another one: -o NAME")
    with open_graph(use_sim_time=use_sim_time) as graph, writing(folder, storage) as writer:
        recording = _Recording(graph, writer, {absolute(topic) for topic in topics})
        click.echo("Recording... Press Ctrl-C to stop.")
        try:
            while True:
                recording.look()
                graph.spin_until(lambda: False, LOOK_AGAIN)
        except cli.StopSignal:
            click.echo(f"{recording.count} messages in {folder}")
            raise


class _Recording:
    """Subscribes to topics as they come up, and writes their messages as the bytes that arrived."""

    def __init__(self, graph: GraphView, writer: Any, wanted: set[str]) -> None:
        self._graph, self._writer, self._wanted = graph, writer, wanted
        self._types = message_types()
        self._subscribed: set[str] = set()
        self.count = 0

    def look(self) -> None:
        """Subscribe to the chosen topics that have come up since the last look."""
        for topic in self._graph.topics():
            is_wanted = topic.name in self._wanted if self._wanted else "/_" not in topic.name
            if is_wanted and topic.name not in self._subscribed and len(topic.types) == 1:
                self._subscribed.add(topic.name)
                self._subscribe(topic.name, topic.types[0])

    def _subscribe(self, topic: str, kind: str) -> None:
        from ros_in_python.ros2 import bag_qos, qos

        message = interfaces.message_class(kind)
        know_type(self._types, kind)
        offered = [bag_qos.of_profile(end.qos_profile) for end in self._graph.publishers(topic)]
        connection = self._writer.add_connection(topic, kind, typestore=self._types, offered_qos_profiles=offered)
        profile = qos.suiting(self._graph, topic, qos.QosOptions("sensor_data"))

        def arrived(data: bytes) -> None:
            self._writer.write(connection, self._graph.node.get_clock().now().nanoseconds, bytes(data))
            self.count += 1

        self._graph.node.create_subscription(message, topic, arrived, profile, raw=True)
        click.echo(f"Subscribed to topic '{topic}'")


@bag.command()
@click.argument("bag_path", type=click.Path(path_type=Path))
@click.option("-r", "--rate", type=click.FloatRange(min=0, min_open=True), default=1.0, help="How fast to play it.")
@click.option("-l", "--loop", is_flag=True, help="Begin again at the end, until Ctrl-C.")
@click.option("--topics", multiple=True, help="Play only this topic; may be given several times.")
def play(bag_path: Path, rate: float, loop: bool, topics: tuple[str, ...]) -> None:
    """Publish what a bag holds, at the pace at which it was recorded.

    \b
      ros2 bag play swing
      ros2 bag play swing --rate 2 --loop
    """
    with reading(bag_path) as reader, open_graph() as graph:
        from ros_in_python.ros2 import bag_qos

        recorded = {connection.topic for connection in reader.connections}
        if missing := sorted(set(topics) - recorded):
            raise CommandError(f"The bag has no topic {missing[0]}.", f"It has: {', '.join(sorted(recorded))}.")
        connections = [each for each in reader.connections if not topics or each.topic in topics]
        publishers = {
            each.topic: graph.node.create_publisher(
                interfaces.message_class(each.msgtype), each.topic, bag_qos.to_profile(each.ext.offered_qos_profiles)
            )
            for each in connections
        }
        graph.settle(lambda: any(publisher.get_subscription_count() for publisher in publishers.values()))
        while True:
            began = time.monotonic()
            for connection, at, data in reader.messages(connections):
                due = began + (at - reader.start_time) / SECOND / rate
                graph.spin_until(lambda: False, max(0.0, due - time.monotonic()))
                publishers[connection.topic].publish(data)
            if not loop:
                return


@bag.command()
@click.argument("bag_path", type=click.Path(path_type=Path))
def info(bag_path: Path) -> None:
    """What is in a bag.

    \b
      ros2 bag info swing
    """
    with reading(bag_path) as reader:
        storage, files = stored_files(bag_path)
        size = sum(file.stat().st_size for file in files)
        start, duration = reader.start_time, duration_of(reader)
        rows = [
            ("Files", " ".join(file.name for file in files)),
            ("Bag size", f"{size / 1024:.1f} KiB"),
            ("Storage id", storage),
            ("ROS Distro", reader.ros_distro or "unknown"),
            ("Duration", f"{duration / SECOND:.9f}s"),
            ("Start", _moment(start)),
            ("End", _moment(start + duration)),
            ("Messages", str(reader.message_count)),
        ]
        for name, value in rows:
            click.echo(f"{name + ':':<19}{value}")
        title = "Topic information: "
        for each in sorted(reader.connections, key=lambda connection: connection.topic):
            about = f"Type: {each.msgtype} | Count: {each.msgcount} | Serialization Format: cdr"
            click.echo(f"{title}Topic: {each.topic} | {about}")
            title = " " * len(title)


def _moment(at: int) -> str:
    return f"{datetime.fromtimestamp(at / SECOND).strftime('%b %d %Y %H:%M:%S')}.{at % SECOND:09d} ({at / SECOND:.9f})"
