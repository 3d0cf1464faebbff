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
    """ROS_DOMAIN_ID as a number. Raises `CommandError` if it is none or out of range."""
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
#: How often the table of sockets is read again, at most, when it changes meanwhile.
_READINGS = 5


def participants(domain: int) -> int | None:
    """The number of participants on this host, this process's own among them; None where it can't be told.

    Discovery is over when as many have been heard of. Another user's count too: they hold ports like anybody.
    """
    try:
        return len(_discovery_sockets(domain)) or None
    except OSError:
        return None


def participates(domain: int, processes: Iterable[int]) -> bool:
    """Whether one of these processes, by their ids, takes part in a ROS domain. False where it can't be told."""
    try:
        wanted = {f"socket:[{inode}]" for inode in _discovery_sockets(domain).values()}
    except OSError:
        return False
    return any(not wanted.isdisjoint(_open_files(process)) for process in processes)


def _open_files(process: int) -> set[str]:
    found = set()
    with contextlib.suppress(OSError):  # it has ended
        for file in Path(f"/proc/{process}/fd").iterdir():
            with contextlib.suppress(OSError):
                found.add(os.fspath(file.readlink()))
    return found


def _discovery_sockets(domain: int) -> dict[int, str]:
    """The inode of each bound discovery port of a domain.

    The kernel hands the table over piece by piece, and leaves rows out when sockets are closed meanwhile: it holds
    only when it has been read twice alike.
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
    """Whether nodes on other hosts may be in this domain, which no port on this one tells of."""
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
