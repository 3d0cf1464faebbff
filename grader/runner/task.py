"""What is to be run."""

from __future__ import annotations

from dataclasses import dataclass

from grader.exercise.exercise import Exercise
from grader.scenario.scenario import Scenario


@dataclass(frozen=True)
class Task:
    """One program, to be run through one scenario.

    `file_name` and `source` are the student's, to name lines in messages. `pace` is 1.0 for real time, and None for as
    fast as possible. `domain` is the ROS domain, for Fast DDS only.
    """

    exercise: Exercise
    scenario: Scenario
    file_name: str
    source: str
    pace: float | None = None
    domain: int = 0
