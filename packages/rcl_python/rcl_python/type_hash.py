"""The hashes of types (REP 2016), as the interface packages install them."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterator
from functools import cache
from importlib import resources
from pathlib import Path

_PREFIX = "RIHS01_"
_TABLE = "type_hashes.json"
"""Next to this file if there is no folder of interface files: type -> hash, as hexadecimal digits."""


@cache
def hash_of(type_name: str) -> bytes:
    """Return the 32 bytes of a type's hash; zeros if it is unknown."""
    text = _table().get(type_name) or _from_index(type_name)
    return bytes.fromhex(text.removeprefix(_PREFIX)) if text else bytes(32)


@cache
def _table() -> dict[str, str]:
    file = resources.files("rcl_python") / _TABLE
    found: dict[str, str] = json.loads(file.read_text(encoding="utf-8")) if file.is_file() else {}
    return found


def _from_index(type_name: str) -> str:
    """Search the description that an interface package installs next to its .msg file."""
    package, middle, name = type_name.split("/")
    for share in _shares(package):
        # A service's and an action's parts are described in the file of the whole.
        for stem in (name, name.rsplit("_", 1)[0], name.rsplit("_", 2)[0]):
            file = share / middle / f"{stem}.json"
            if file.is_file():
                found = {item["type_name"]: item["hash_string"] for item in json.loads(file.read_text())["type_hashes"]}
                if type_name in found:
                    return str(found[type_name])
    return ""


def _shares(package: str) -> Iterator[Path]:
    prefixes = [*os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep), sys.prefix]
    yield from (Path(prefix, "share", package) for prefix in prefixes if prefix)
