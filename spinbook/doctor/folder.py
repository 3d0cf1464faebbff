"""Whether the places where Spinbook and the course lie are ones that colcon can work in."""

from __future__ import annotations

import sys
from pathlib import Path

from spinbook.doctor.finding import Finding, missing, ok


def examine(name: str) -> Finding:
    """Look for characters that colcon's shell scripts, or the search paths, fall apart at."""
    places = (Path.cwd(), Path(sys.prefix))
    for place in places:
        if any(character.isspace() or character == ":" for character in str(place)):
            return missing(
                name,
                f"'{place}' has a space or a colon in it",
                "colcon's scripts and ROS's search paths fall apart there. "
                "Move it to a path without one, and run make again.",
            )
    return ok(name, f"{places[0]} (environment: {places[1]})")
