"""The hashes of types, as stored in the packages of the types.

Source: REP 2016, and what rosidl_generator_type_description installs next to each definition: a .json file with the
hashes of the type and of those that it consists of.
"""

from __future__ import annotations

import json
import os
import re
import sys
from collections.abc import Iterator
from functools import cache
from importlib import resources
from pathlib import Path

#: Bytes of a type hash: its version, and SHA-256.
HASH_BYTES = 33

#: The hash of a type whose package has no hashes: version 0 means "none".
NO_HASH = bytes(HASH_BYTES)

_HASH = re.compile(r"RIHS(?P<version>\d\d)_(?P<value>[0-9a-f]{64})")

#: Next to this file if the packages' own files are not installed, as in a web page: type -> hash.
_TABLE = "type_hashes.json"


@cache
def type_hash(type_name: str) -> bytes:
    """Return the hash of a type such as `std_msgs/msg/String`: its version (1 byte), and SHA-256 (32 bytes)."""
    for hashes in (_table(), *_stored(type_name)):
        if known := _HASH.fullmatch(hashes.get(type_name, "")):
            return bytes([int(known["version"])]) + bytes.fromhex(known["value"])
    return NO_HASH


@cache
def _table() -> dict[str, str]:
    file = resources.files("rmw_lockstep") / _TABLE
    hashes: dict[str, str] = json.loads(file.read_text(encoding="utf-8")) if file.is_file() else {}
    return hashes


def _stored(type_name: str) -> Iterator[dict[str, str]]:
    """Yield the hashes in each file that may have this type's, in each prefix of ROS packages."""
    package, _, name = type_name.partition("/")
    prefixes = [entry for entry in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if entry]
    for prefix in (*prefixes, sys.prefix):
        # The parts of a service are in the file of the whole; those of an action may have files of their own.
        for stem in (name, name.rsplit("_", 1)[0], name.rsplit("_", 2)[0]):
            file = Path(prefix, "share", package, f"{stem}.json")
            if file.is_file():
                yield {one["type_name"]: one["hash_string"] for one in json.loads(file.read_bytes())["type_hashes"]}
