"""The ROS domain that this process is in, and which processes take part in one: the kernel's table of ports says so."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterable
from pathlib import Path

from ros_in_python.ros2.cli import CommandError

#: Above this, DDS has no port numbers left (https://docs.ros.org/en/jazzy/Concepts/Intermediate/About-Domain-ID.html).
LARGEST_DOMAIN = 232


def domain_id() -> int:
    """Return ROS_DOMAIN_ID as a number. Raises `CommandError` if it is not one, or out of range."""
    text = os.environ.get("ROS_DOMAIN_ID") or "0"
    if not text.isdecimal() or int(text) > LARGEST_DOMAIN:
        raise CommandError(
            f"ROS_DOMAIN_ID is '{text}', expected a whole number from 0 to {LARGEST_DOMAIN}.",
            "Every terminal and notebook that should see one another needs the same number.",
        )
    return int(text)


# The well-known ports of RTPS 2.5, 9.6.2.3: 7400 + 250 * domain, and each participant's unicast discovery
# port is that plus 10 plus twice the participant's number.
_FIRST_PORT = 7400
_PORTS_A_DOMAIN = 250
_FIRST_UNICAST = 10
#: The most readings of the table of sockets, if it keeps changing.
_READINGS = 5


def participants(domain: int) -> int | None:
    """Return the number of participants on this host, including this process's own; None if the kernel does not say.

    Discovery is over when as many have been found. Another user's count, too: they also hold ports.
    """
    try:
        return len(_discovery_sockets(domain)) or None
    except OSError:
        return None


def participates(domain: int, processes: Iterable[int]) -> bool:
    """Return whether one of these processes (ids) takes part in a ROS domain; False if the kernel does not say."""
    try:
        sockets = {f"socket:[{inode}]" for inode in _discovery_sockets(domain).values()}
    except OSError:
        return False
    return any(not sockets.isdisjoint(_open_files(process)) for process in processes)


def _open_files(process: int) -> set[str]:
    found = set()
    with contextlib.suppress(OSError):  # it has ended
        for file in Path(f"/proc/{process}/fd").iterdir():
            with contextlib.suppress(OSError):
                found.add(os.fspath(file.readlink()))
    return found


def _discovery_sockets(domain: int) -> dict[int, str]:
    """Return discovery port -> inode of its socket, for each port of a domain that is bound.

    The kernel returns the table in pieces, and omits rows when sockets are closed meanwhile: it is complete only
    when two readings are equal.
    """
    before = None
    for _ in range(_READINGS):
        found = _read_discovery_sockets(domain)
        if found == before:
            break
        before = found
    return found


def _read_discovery_sockets(domain: int) -> dict[int, str]:
    base = _FIRST_PORT + _PORTS_A_DOMAIN * domain
    discovery = range(base + _FIRST_UNICAST, base + _PORTS_A_DOMAIN, 2)
    rows = (row.split() for row in Path("/proc/self/net/udp").read_text().splitlines()[1:])
    bound = {int(row[1].rpartition(":")[2], 16): row[9] for row in rows}
    return {port: inode for port, inode in bound.items() if port in discovery}


def hears_other_hosts() -> bool:
    """Return whether this domain may have nodes on other hosts, which local ports do not show."""
    if os.environ.get("ROS_LOCALHOST_ONLY") == "1":
        return False
    if os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE", "").upper() in ("LOCALHOST", "OFF"):
        return False
    profile = os.environ.get("FASTRTPS_DEFAULT_PROFILES_FILE")
    if not profile:
        return True
    try:
        text = Path(profile).read_text(errors="replace")
    except OSError:
        return True
    whitelist = text.partition("<interfaceWhiteList>")[2].partition("</interfaceWhiteList>")[0]
    return "127.0.0.1" not in whitelist
