"""`ros2 bag`: record, play and info, over bags in MCAP, which Foxglove and PlotJuggler open, and in sqlite3."""

from __future__ import annotations

import re
import time
from collections.abc import Callable
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from ros_in_python.ros2 import cli, interfaces
from ros_in_python.ros2 import interfaces as interface_files
from ros_in_python.ros2.cli import CONTEXT, CommandError, Menu, MenuEntry
from ros_in_python.ros2.opening import open_graph

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ros_in_python.ros2.graph import GraphView

SECOND = 1_000_000_000

#: Seconds between two looks for new topics.
LOOK_AGAIN = 0.5

bag = Menu(
    name="bag",
    entries={
        "info": MenuEntry("ros_in_python.ros2.bag:info", "What is in a bag."),
        "play": MenuEntry("ros_in_python.ros2.bag:play", "Publish what a bag holds."),
        "record": MenuEntry("ros_in_python.ros2.bag:record", "Write messages into a bag until Ctrl-C."),
    },
    help="""Record topics into a file, and play them again.

    \b
      ros2 bag record -o swing /joint_commands
      ros2 bag info swing
      ros2 bag play swing
    """,
)


@click.command(context_settings=CONTEXT)
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
    with open_graph(use_sim_time=use_sim_time) as graph, _writer(folder, storage) as writer:
        from ros_in_python.ros2.graph import absolute

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
        self._types = _types()
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
        _know(self._types, kind)
        offered = [bag_qos.of_profile(end.qos_profile) for end in self._graph.publishers(topic)]
        connection = self._writer.add_connection(topic, kind, typestore=self._types, offered_qos_profiles=offered)
        profile = qos.suiting(self._graph, topic, qos.QosOptions("sensor_data"))

        def arrived(data: bytes) -> None:
            self._writer.write(connection, self._graph.node.get_clock().now().nanoseconds, bytes(data))
            self.count += 1

        self._graph.node.create_subscription(message, topic, arrived, profile, raw=True)
        click.echo(f"Subscribed to topic '{topic}'")


@click.command(context_settings=CONTEXT)
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
    with _reader(bag_path) as reader, open_graph() as graph:
        from ros_in_python.ros2 import bag_qos

        connections = [one for one in reader.connections if not topics or one.topic in topics]
        publishers = {
            one.topic: graph.node.create_publisher(
                interfaces.message_class(one.msgtype), one.topic, bag_qos.to_profile(one.ext.offered_qos_profiles)
            )
            for one in connections
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


@click.command(context_settings=CONTEXT)
@click.argument("bag_path", type=click.Path(path_type=Path))
def info(bag_path: Path) -> None:
    """What is in a bag.

    \b
      ros2 bag info swing
    """
    with _reader(bag_path) as reader:
        storage, files = _stored(bag_path)
        size = sum(file.stat().st_size for file in files)
        start, end = reader.start_time, reader.start_time + reader.duration
        rows = [
            ("Files", " ".join(file.name for file in files)),
            ("Bag size", f"{size / 1024:.1f} KiB"),
            ("Storage id", storage),
            ("ROS Distro", reader.ros_distro or "unknown"),
            ("Duration", f"{reader.duration / SECOND:.9f}s"),
            ("Start", _moment(start)),
            ("End", _moment(end)),
            ("Messages", str(reader.message_count)),
        ]
        for name, value in rows:
            click.echo(f"{name + ':':<19}{value}")
        title = "Topic information: "
        for one in sorted(reader.connections, key=lambda one: one.topic):
            click.echo(
                f"{title}Topic: {one.topic} | Type: {one.msgtype} | Count: {one.msgcount} | Serialization Format: cdr"
            )
            title = " " * len(title)


def _stored(bag: Path) -> tuple[str, list[Path]]:
    """Return how a bag is stored, and its files."""
    storages = {".mcap": "mcap", ".db3": "sqlite3"}
    files = [file for file in sorted(bag.iterdir()) if file.suffix in storages] if bag.is_dir() else [bag]
    return (storages.get(files[0].suffix, "unknown") if files else "unknown"), files


def _moment(at: int) -> str:
    return f"{datetime.fromtimestamp(at / SECOND).strftime('%b %d %Y %H:%M:%S')}.{at % SECOND:09d} ({at / SECOND:.9f})"


@contextmanager
def _writer(folder: Path, storage: str) -> Iterator[Any]:
    rosbag2 = _library()
    writer = rosbag2.Writer(folder, version=9, storage_plugin=rosbag2.StoragePlugin[storage.upper()])
    writer.open()
    try:
        yield writer
    finally:
        # The library's own context manager leaves a bag unfinished after Ctrl-C.
        writer.close()
        _number(folder)


def _number(folder: Path) -> None:
    """Name a bag's file as ROS 2 does, which begins a new one when it is large: NAME_0.mcap."""
    metadata = folder / "metadata.yaml"
    text = metadata.read_text(encoding="utf-8")
    for file in _stored(folder)[1]:
        numbered = file.with_name(f"{file.stem}_0{file.suffix}")
        text = re.sub(rf"\b{re.escape(file.name)}$", numbered.name, text, flags=re.MULTILINE)
        file.rename(numbered)
    metadata.write_text(text, encoding="utf-8")


@contextmanager
def _reader(folder: Path) -> Iterator[Any]:
    rosbag2 = _library()
    try:
        reader = rosbag2.Reader(folder)
        reader.open()
    except Exception as error:  # whatever a damaged file leads the library to
        raise CommandError(
            f"'{folder}' can't be read as a bag: {error}", "Name the folder that `ros2 bag record` made."
        ) from None
    try:
        yield reader
    finally:
        reader.close()


def _library() -> Any:
    try:
        from rosbags import rosbag2
    except ImportError:
        raise CommandError("Bags need the package rosbags: pip install rosbags") from None
    return rosbag2


def _types() -> Any:
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.ROS2_JAZZY)


def _know(types: Any, kind: str) -> None:
    """Register a type that does not come with ROS 2 itself, and the types of its fields, with the library."""
    from rosbags.typesys import get_types_from_msg

    if kind in types.types:
        return
    package, _, name = kind.split("/")
    text = (interface_files.folder_of(package) / "msg" / f"{name}.msg").read_text(encoding="utf-8")
    found = get_types_from_msg(text, kind)
    for used in _named(found):
        if used not in found:
            _know(types, used)
    types.register({one: fields for one, fields in found.items() if one not in types.types})


def _named(found: Any) -> list[str]:
    """Return the message types of these definitions' fields."""
    names: list[str] = []
    take: Callable[[Any], None] = lambda part: names.append(part[1]) if part[0].name == "NAME" else None  # noqa: E731
    for _, fields in found.values():
        for _, (node, detail) in fields:
            take((node, detail))
            if node.name in ("ARRAY", "SEQUENCE"):
                take(detail[0])
    return names
