"""`ros2 multicast`: whether UDP multicast, by which nodes on several computers find each other, gets through."""

from __future__ import annotations

import socket
import struct

import click

from ros_in_python.ros2.cli import CommandError, Menu

#: The group and the port of the real command.
GROUP, PORT = "225.0.0.1", 49150

multicast = Menu(
    name="multicast",
    help="""Try whether UDP multicast gets from one computer to another.

    \b
      ros2 multicast receive      on one computer
      ros2 multicast send         on the other
    """,
)
_group = click.option("--group", default=GROUP, show_default=True, help="The multicast group.")
_port = click.option("--port", type=click.IntRange(1, 65535), default=PORT, show_default=True, help="The UDP port.")


def receiver(group: str, port: int) -> socket.socket:
    """Return a socket that receives what is sent to a group. Raises OSError."""
    end = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        end.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        end.bind(("", port))
        membership = struct.pack("4sl", socket.inet_aton(group), socket.INADDR_ANY)
        end.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, membership)
    except OSError:
        end.close()
        raise
    return end


def sender(ttl: int | None) -> socket.socket:
    """Return a socket that sends to groups, by way of `ttl` routers at most. Raises OSError."""
    end = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    if ttl is not None:
        end.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, ttl)
    return end


@multicast.command()
@_group
@_port
@click.option("--timeout", type=click.FloatRange(min=0, min_open=True), metavar="N", help="Stop after N seconds.")
def receive(group: str, port: int, timeout: float | None) -> None:
    """Wait for one datagram, and print it.

    \b
      ros2 multicast receive --timeout 10
    """
    click.echo("Waiting for UDP multicast datagram...")
    try:
        with receiver(group, port) as end:
            end.settimeout(timeout)
            data, (source, from_port) = end.recvfrom(4096)
    except TimeoutError:
        raise CommandError(
            f"Nothing arrived within {timeout:g} s: a firewall or the network keeps multicast back."
        ) from None
    except OSError as error:
        raise CommandError(f"Multicast can't be received here: {error.strerror or error}") from None
    click.echo(f"Received from {source}:{from_port}: {data.decode(errors='replace')!r}")


@multicast.command()
@_group
@_port
@click.option("--ttl", type=click.IntRange(1, 255), default=1, show_default=True, help="How many routers it may pass.")
def send(group: str, port: int, ttl: int) -> None:
    """Send one datagram.

    \b
      ros2 multicast send
    """
    click.echo("Sending one UDP multicast datagram...")
    try:
        with sender(ttl) as end:
            end.sendto(b"Hello World!", (group, port))
    except OSError as error:
        raise CommandError(f"Multicast can't be sent here: {error.strerror or error}") from None
