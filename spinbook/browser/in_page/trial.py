"""Trying a node out in an exercise's page, as `%try` does in a notebook: what surrounds it plays in real time."""

from __future__ import annotations

import json
from collections.abc import Callable
from typing import Any

from grader.exercise.data_files import LACKS
from grader.exercise.exercise import Exercise
from grader.exercise.loading import load
from grader.recording.recording import Recording
from grader.report.feedback_plot import picture
from grader.runner.program import CannotContinue
from grader.scenario.command_line import arguments
from grader.scenario.scenario import Scenario
from spinbook.browser.in_page.check import CheckedProgram, public_part, unpacked
from spinbook.kernel.surroundings import SEVERAL, events_of, play
from spinbook.kernel.timeline import in_words, lanes
from spinbook.kernel.timeline_picture import moving_timeline, span_of


def plan(name: str, chosen: str) -> str:
    """Return how to try an exercise out, as JSON: the arguments of the node, and all scenarios; or `problem` alone."""
    exercise = load(unpacked(name)).public()
    scenarios, _, _ = public_part(exercise)
    scenario = _chosen(scenarios, chosen)
    if exercise.programs or scenario.companions or scenario.programs:
        return json.dumps({"problem": SEVERAL.format(scenario.name)})
    if (lacks := exercise.folder / LACKS).exists():
        return json.dumps({"problem": lacks.read_text()})
    words = arguments(scenario, always=("--ros-args",))
    return json.dumps({"args": words, "scenario": scenario.name, "scenarios": [one.name for one in scenarios]})


def _chosen(scenarios: list[Scenario], name: str) -> Scenario:
    return next((one for one in scenarios if one.name == name), scenarios[0])


def play_around(page: Any, name: str, chosen: str) -> None:
    """Play a scenario to its end or until interrupted; print what happens, and send its picture to the page."""
    exercise = load(unpacked(name)).public()
    scenarios, references, _ = public_part(exercise)
    scenario = _chosen(scenarios, chosen)
    draw = _drawing(exercise, references[scenario.name], page)
    try:
        play(exercise, scenario, print, draw)
    except CannotContinue as stopped:
        print(stopped.message)
    except KeyboardInterrupt:
        print("Stopped.")


def _drawing(exercise: Exercise, reference: Recording, page: Any) -> Callable[[Recording], None]:
    shown = [""]

    def draw(recording: Recording) -> None:
        drawn = _timeline(recording, exercise) if recording.calls or recording.goals else _curves(recording, exercise)
        if drawn["svg"] not in ("", shown[0]):
            shown[0] = drawn["svg"]
            page.picture(json.dumps(drawn))

    def _curves(recording: Recording, exercise: Exercise) -> dict[str, str]:
        name = recording.scenario
        tried: Any = CheckedProgram((), {name: recording}, {name: reference})
        return {"svg": picture(tried, exercise, judged=False) or "", "words": "What your node does, over the solution"}

    return draw


def _timeline(recording: Recording, exercise: Exercise) -> dict[str, str]:
    drawn = lanes(events_of(recording))
    if not any(lane.marks for lane in drawn):
        return {"svg": "", "words": ""}
    words = in_words(drawn, span_of(drawn)[0])
    return {"svg": moving_timeline(drawn, exercise.title, moves=False), "words": words}
