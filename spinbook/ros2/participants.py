"""How many DDS participants this host has in a ROS domain, by the ports they have bound. Needs no rclpy."""

from __future__ import annotations

import os
from pathlib import Path

# The well-known ports of RTPS 2.5, 9.6.2.3: 7400 + 250 * domain, and each participant's unicast discovery
# port is that plus 10 plus twice the participant's number.
_FIRST_PORT = 7400
_PORTS_A_DOMAIN = 250
_FIRST_UNICAST = 10


def participants(domain: int) -> int | None:
    """The number of participants on this host, this process's own among them; None where it can't be told.

    Discovery is over when as many have been heard of. Another user's count too: they hold ports like anybody.
    """
    base = _FIRST_PORT + _PORTS_A_DOMAIN * domain
    discovery = range(base + _FIRST_UNICAST, base + _PORTS_A_DOMAIN, 2)
    try:
        rows = Path("/proc/self/net/udp").read_text().splitlines()[1:]
    except OSError:
        return None
    bound = {int(row.split()[1].rpartition(":")[2], 16) for row in rows}
    return sum(port in bound for port in discovery) or None


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
