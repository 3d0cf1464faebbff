"""The kinds of exercises for which there is a template.

Each template is a working exercise, in the folders `exercises` and `solutions`, as in a course.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

#: A whole course, whose only exercise is the template of a filter.
COURSE = Path(__file__).parent / "template"

_KINDS = Path(__file__).parent / "kinds"


@dataclass(frozen=True)
class Kind:
    """One kind of exercise: what its node does, and its template.

    `exercise` is the template's own name, and `title` its title. `root` contains its `exercises` and `solutions`.
    """

    name: str
    summary: str
    exercise: str
    title: str
    root: Path = _KINDS


#: In the order in which a course would teach them.
KINDS = (
    Kind("filter", "one message in, one message out", "speed_limit", "A speed limit", COURSE),
    Kind("publisher", "messages at a steady rate, by a timer", "lighthouse_beam", "The beam of a lighthouse"),
    Kind(
        "latched-topic",
        "keeps its last message for late subscribers",
        "departure_board",
        "A board of departures",
    ),
    Kind(
        "parameters",
        "set at the start, changed while it runs",
        "room_thermostat",
        "A thermostat with parameters",
    ),
    Kind("service-server", "answers requests", "coin_turnstile", "A turnstile that takes coins"),
    Kind("service-client", "calls a service and never waits", "fire_watch", "A fire watch that calls the sprinkler"),
    Kind("action-server", "goals, feedback, results, cancel", "telescope_mount", "A telescope that turns on request"),
    Kind("action-client", "sends goals that may fail", "night_observer", "An observer of the night sky"),
    Kind("closed-loop", "steers a small simulated world", "ship_autopilot", "An autopilot that keeps a ship on course"),
    Kind("several-nodes", "two programs that work together", "bottle_line", "A bottling line of two nodes"),
)

BY_NAME = {kind.name: kind for kind in KINDS}
