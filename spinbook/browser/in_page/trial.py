"""Trying a node out in an exercise's page, as `%try` does in a notebook: what surrounds it plays in real time."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

from grader.exercise.data_files import LACKS
from grader.exercise.exercise import Exercise
from grader.exercise.loading import load
from grader.recording.recording import Recording
from grader.report.feedback_plot import picture
from grader.runner.program import CannotContinue
from grader.scenario.command_line import arguments
from grader.scenario.scenario import Scenario
from ros_in_python.robot.drawing import RobotMotion, as_data
from spinbook.browser.in_page.check import CheckedProgram, public_part, unpacked
from spinbook.kernel.surroundings import SEVERAL, events_of, play, robot_of
from spinbook.kernel.timeline import in_words, lanes
from spinbook.kernel.timeline_picture import span_of, timeline_svg


def plan(name: str, chosen: str) -> dict[str, Any]:
    """Return how to try an exercise out: the arguments of the node, and all scenarios; or `problem` alone."""
    exercise = load(unpacked(name)).public()
    scenarios, _, _ = public_part(exercise)
    scenario = _chosen(scenarios, chosen)
    if exercise.programs or scenario.companions or scenario.programs:
        return {"problem": SEVERAL.format(scenario.name)}
    if (lacks := exercise.folder / LACKS).exists():
        return {"problem": lacks.read_text()}
    words = arguments(scenario, always=("--ros-args",))
    return {"args": words, "scenario": scenario.name, "scenarios": [each.name for each in scenarios]}


def _chosen(scenarios: list[Scenario], name: str) -> Scenario:
    return next((each for each in scenarios if each.name == name), scenarios[0])


def play_around(page: Any, name: str, chosen: str) -> None:
    """Play a scenario to its end or until interrupted; print what happens, and send its picture to the page."""
    exercise = load(unpacked(name)).public()
    scenarios, references, _ = public_part(exercise)
    scenario = _chosen(scenarios, chosen)
    shown = LivePicture(page, exercise, references[scenario.name])
    try:
        play(exercise, scenario, print, shown.draw)
    except CannotContinue as stopped:
        print(stopped.message)
    except KeyboardInterrupt:
        print("Stopped.")


@dataclass
class LivePicture:
    """The picture of what happens, for the page, drawn again whenever that changes."""

    page: Any
    exercise: Exercise
    reference: Recording
    shown: str = ""

    def draw(self, recording: Recording) -> None:
        """Send the page the picture of what has happened so far, if it is new."""
        curves = {} if recording.calls or recording.goals else self._curves(recording)
        drawn = json.dumps(self._robot(recording) or curves or self._timeline(recording))
        if drawn not in ("{}", self.shown):
            self.shown = drawn
            self.page.picture(drawn)

    def _robot(self, recording: Recording) -> dict[str, Any]:
        robot = robot_of(recording)
        return {"robot": as_data(robot, RobotMotion()), "kind": "robot"} if robot else {}

    def _curves(self, recording: Recording) -> dict[str, str]:
        name = recording.scenario
        tried: Any = CheckedProgram((), {name: recording}, {name: self.reference})
        svg = picture(tried, self.exercise, judged=False)
        return {"svg": svg, "words": "What your node does, over the solution", "kind": "check-plot"} if svg else {}

    def _timeline(self, recording: Recording) -> dict[str, str]:
        drawn = lanes(events_of(recording))
        if not any(lane.marks for lane in drawn):
            return {}
        words = in_words(drawn, span_of(drawn)[0])
        svg = timeline_svg(drawn, self.exercise.title, moves=False)
        return {"svg": svg, "words": words, "kind": "live-timeline"}
