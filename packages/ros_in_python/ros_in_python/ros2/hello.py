"""`ros2 doctor hello`: whether several computers hear each other, over a topic and over UDP multicast."""

from __future__ import annotations

import contextlib
import socket
import time
from collections import Counter
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import click

from ros_in_python.ros2.cli import CommandError
from ros_in_python.ros2.multicast import GROUP, PORT, receiver, sender
from ros_in_python.ros2.opening import open_graph

if TYPE_CHECKING:
    from collections.abc import Callable

_SECONDS = click.FloatRange(min=0, min_open=True)


@dataclass
class _Tally:
    """What was sent and heard since the last table; what this computer says itself does not count as heard."""

    published: int = 0
    sent: int = 0
    subscribed: Counter[str] = field(default_factory=Counter)
    received: Counter[str] = field(default_factory=Counter)

    def clear(self) -> None:
        """Begin again."""
        self.published = self.sent = 0
        self.subscribed.clear()
        self.received.clear()

    def table(self, topic: str, period: float) -> str:
        """Return the real command's table."""
        return "\n".join(
            [
                "MULTIMACHINE COMMUNICATION SUMMARY",
                f"Topic: {topic}, Published Msg Count: {self.published}",
                "Subscribed from:",
                *_rows(self.subscribed, period),
                f"Multicast Group/Port: {GROUP}/{PORT}, Sent Msg Count: {self.sent}",
                "Received from:",
                *_rows(self.received, period),
                "-" * 60,
            ]
        )


def _rows(heard: Counter[str], period: float) -> list[str]:
    rows = [("Hostname", f"Msg Count /{period}s"), *heard.items()]
    return [f"{'':<15} {name:<20} {count:<10}" for name, count in rows]


@click.command()
@click.option("-t", "--topic", default="/canyouhearme", show_default=True, help="The topic on which they say hello.")
@click.option("-ep", "--emit-period", type=_SECONDS, default=0.1, show_default=True, help="Seconds between two hellos.")
@click.option(
    "-pp", "--print-period", type=_SECONDS, default=1.0, show_default=True, help="Seconds between two tables."
)
@click.option("--ttl", type=click.IntRange(1, 255), help="How many routers multicast may pass.")
@click.option("-1", "--once", is_flag=True, help="Say hello once, print a table, and end.")
def hello(topic: str, emit_period: float, print_period: float, ttl: int | None, once: bool) -> None:
    """Try whether several computers hear each other: start it on each of them.

    \b
      ros2 doctor hello
    """
    tally = _Tally()
    try:
        with open_graph() as graph, receiver(GROUP, PORT) as ears, sender(ttl) as mouth:
            ears.setblocking(False)
            publish = _topic(graph, topic, tally)
            printed = time.monotonic()
            while True:
                publish()
                mouth.sendto(_greeting().encode(), (GROUP, PORT))
                tally.sent += 1
                graph.spin_until(lambda: False, emit_period)
                _listen(ears, tally)
                if once or time.monotonic() - printed > print_period:
                    click.echo(tally.table(topic, print_period))
                    tally.clear()
                    printed = time.monotonic()
                if once:
                    return
    except OSError as error:
        raise CommandError(f"Multicast can't be used here: {error.strerror or error}") from None


def _greeting() -> str:
    return f"hello, it's me {socket.gethostname()}"


def _count(heard: Counter[str], text: str) -> None:
    name = (text.split() or [""])[-1]
    if name != socket.gethostname():
        heard[name] += 1


def _topic(graph: Any, topic: str, tally: _Tally) -> Callable[[], None]:
    """Subscribe to the topic, and return a function that publishes on it."""
    from std_msgs.msg import String

    publisher = graph.node.create_publisher(String, topic, 10)
    graph.node.create_subscription(String, topic, lambda message: _count(tally.subscribed, message.data), 10)

    def publish() -> None:
        publisher.publish(String(data=_greeting()))
        tally.published += 1

    return publish


def _listen(ears: socket.socket, tally: _Tally) -> None:
    """Count all datagrams that have arrived."""
    with contextlib.suppress(BlockingIOError):
        while True:
            _count(tally.received, ears.recv(4096).decode(errors="replace"))
