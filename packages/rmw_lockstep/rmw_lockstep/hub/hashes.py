"""Type hashes of the hub's own end points, as stored in the packages of the types.

Source: REP 2016, and what rosidl_generator_type_description installs next to each definition: a .json file with the
hashes of the type and of those that it consists of. The parts of an action have files of their own.
"""

from __future__ import annotations

import json
import os
import re
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from rmw_lockstep.hub.frames import HASH_BYTES

#: For a type whose package has none: version 0 is "none".
NO_HASH = bytes(HASH_BYTES)

_HASH = re.compile(r"RIHS(?P<version>\d\d)_(?P<value>[0-9a-f]{64})")


@cache
def type_hash(type_name: str) -> bytes:
    """Return the hash of a type such as `std_msgs/msg/String`: its version (1 byte), and SHA-256 (32 bytes)."""
    package, _, name = type_name.partition("/")
    for file in _files(package, f"{name}.json"):
        hashes = {one["type_name"]: one["hash_string"] for one in json.loads(file.read_bytes())["type_hashes"]}
        if found := _HASH.fullmatch(hashes.get(type_name, "")):
            return bytes([int(found["version"])]) + bytes.fromhex(found["value"])
    return NO_HASH


def _files(package: str, name: str) -> Iterator[Path]:
    """Yield the file of that name in each prefix of ROS packages that has one."""
    prefixes = [entry for entry in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if entry]
    for prefix in (*prefixes, sys.prefix):
        file = Path(prefix, "share", package, name)
        if file.is_file():
            yield file
