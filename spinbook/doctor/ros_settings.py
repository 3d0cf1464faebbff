"""Whether the environment holds ROS settings that surprise people."""

from __future__ import annotations

import os
from pathlib import Path

from spinbook.doctor.finding import Finding, ok, warning
from spinbook.runtime.domain import HIGHEST
from spinbook.runtime.environment import LOOPBACK_PROFILE

_PROFILES = ("FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_DEFAULT_PROFILES_FILE")
_WATCHED = (
    "ROS_DOMAIN_ID",
    "ROS_AUTOMATIC_DISCOVERY_RANGE",
    "ROS_LOCALHOST_ONLY",
    "ROS_STATIC_PEERS",
    "ROS_DISCOVERY_SERVER",
    "FASTDDS_BUILTIN_TRANSPORTS",
    *_PROFILES,
)


def examine(name: str) -> Finding:
    """Look at the variables that decide which nodes see one another."""
    surprises = [*_about_domain(), *_about_profiles(), *_about_discovery()]
    if surprises:
        return warning(name, "; ".join(found for found, _ in surprises), "\n".join(mend for _, mend in surprises))
    is_set = [f"{variable}={os.environ[variable]}" for variable in _WATCHED if os.environ.get(variable)]
    return ok(name, ", ".join(is_set) or "none set: domain 0, notebooks in domains of their own")


def _about_domain() -> list[tuple[str, str]]:
    text = os.environ.get("ROS_DOMAIN_ID", "")
    if not text or (text.isdecimal() and int(text) <= HIGHEST):
        return []
    return [
        (
            f"ROS_DOMAIN_ID is '{text}'",
            f"Take one from 0 to {HIGHEST} (others have no ports, or the system's own): export ROS_DOMAIN_ID=0",
        )
    ]


def _about_profiles() -> list[tuple[str, str]]:
    for variable in _PROFILES:
        file = os.environ.get(variable, "")
        if file and not Path(file).is_file():
            return [(f"{variable} names {file}, which does not exist", f"unset {variable}")]
        if file and Path(file) != LOOPBACK_PROFILE:
            return [
                (
                    f"{variable}={file}",
                    "Notebooks and the grader use profiles of their own in its place; your terminals use this one. "
                    f"If they do not hear one another: unset {variable}",
                )
            ]
    return []


def _about_discovery() -> list[tuple[str, str]]:
    surprises = []
    if os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE", "").upper() == "OFF":
        surprises.append(
            (
                "ROS_AUTOMATIC_DISCOVERY_RANGE is OFF",
                "Terminals won't find any node: unset ROS_AUTOMATIC_DISCOVERY_RANGE",
            )
        )
    if os.environ.get("ROS_DISCOVERY_SERVER"):
        surprises.append(
            (
                "ROS_DISCOVERY_SERVER is set",
                "Nodes of notebooks would ask that server for one another: unset ROS_DISCOVERY_SERVER",
            )
        )
    return surprises
