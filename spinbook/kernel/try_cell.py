"""`%try`: an exercise's node runs in real time among what surrounds it, and a picture shows what it does."""

from __future__ import annotations

import contextlib
import functools
import os
import tempfile
import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from grader.exercise.exercise import Exercise, ExerciseError
from grader.grading.grade import Grade
from grader.grading.public import playable, read_public
from grader.recording.recording import Recording, from_json
from grader.report.plot import scenario_picture
from grader.scenario.command_line import arguments
from grader.scenario.scenario import Scenario
from groundwork.clean_environment import module_command
from ros_in_python.robot import drawing, still
from ros_in_python.robot.urdf import RobotDescription
from spinbook.kernel.check_cell import exercise_of, notebook_file
from spinbook.kernel.environment import EXECUTING
from spinbook.kernel.picture_cells import show_picture
from spinbook.kernel.process import STOP_GRACE
from spinbook.kernel.session import Session
from spinbook.kernel.timeline import in_words, lanes
from spinbook.kernel.timeline_picture import span_of, timeline_svg
from spinbook.package.cell_line import CellFailed

#: The name of what surrounds the node, for `%stop` and `%log`.
SURROUNDINGS = "surroundings"
#: The time between two looks at the recording (s).
_LOOK_S = 0.1


def try_out(session: Session, shell: Any, name: str, scenario_name: str, course: str) -> None:
    """Run the node of the exercise `name` among what surrounds it, until that ends or Stop. Raises CellFailed."""
    exercise = exercise_of(name, course, notebook_file(shell))
    node = exercise.file_name.removesuffix(".py")
    if node not in session.starts:
        raise CellFailed(f"Run the cell that begins with %%node {node} first. Then run this one again.")
    scenario = _scenario(exercise, scenario_name)
    with tempfile.TemporaryDirectory(prefix="spinbook-") as folder:
        record = Path(folder, "recording.json")
        command = module_command("spinbook.start", "try", os.fspath(exercise.folder), scenario.name, flags=("-u",))
        command += ["--record", os.fspath(record)]
        surroundings = session.nodes.start(SURROUNDINGS, command, {}, Path.cwd())
        session.restart(node, arguments(scenario, always=("--ros-args",)))
        picture = TriedPicture(exercise, scenario, record)
        try:
            while surroundings.process.status.running:
                print(surroundings.process.read()[0].decode(errors="replace"), end="")
                picture.look()
                time.sleep(_LOOK_S)
        except KeyboardInterrupt:
            surroundings.process.stop()
            surroundings.process.wait(sum(STOP_GRACE) + 1)
        print(surroundings.process.read()[0].decode(errors="replace"), end="")
        picture.look(last=True)
    ended = session.nodes.stop(SURROUNDINGS).status
    if ended.exit:
        raise CellFailed("It could not be played: see above.")
    print(f"— what {node} printed:\n{session.log(node, False).rstrip()}")
    if session.nodes.status(node).running:
        print(f"— {node} continues in the background: %stop {node} ends it\N{NO-BREAK SPACE}—")


def _scenario(exercise: Exercise, name: str) -> Scenario:
    try:
        scenarios = playable(exercise)
    except ExerciseError as error:
        raise CellFailed(f"The exercise is at fault, not your code.\n{error}") from None
    if name and name not in scenarios:
        raise CellFailed(f"{exercise.name} has no scenario `{name}`. There are: {', '.join(scenarios)}.")
    return scenarios[name] if name else next(iter(scenarios.values()))


@dataclass
class TriedPicture:
    """The picture below a `%try`, drawn again whenever `record` has changed."""

    exercise: Exercise
    scenario: Scenario
    record: Path
    changed: float = 0.0
    handle: Any = None

    def look(self, *, last: bool = False) -> None:
        """Draw what has happened so far, if that is new. Where nobody watches, only the last picture is shown."""
        with contextlib.suppress(OSError):
            changed = self.record.stat().st_mtime
            if changed > self.changed and (last or EXECUTING not in os.environ):
                self.changed = changed
                self._show(from_json(self.record.read_text(encoding="utf-8"))[self.scenario.name])

    def _show(self, recording: Recording) -> None:
        pictures, words = self._picture(recording)
        if pictures:
            self.handle = show_picture(pictures, words, self.handle)

    def _picture(self, recording: Recording) -> tuple[dict[str, Any], str]:
        """Return a robot, curves, or else what happened over time, by media type and in words; ({}, "") if nothing
        did.
        """
        # Imported here because it imports rclpy.
        from spinbook.kernel.surroundings import events_of, robot_of

        if robot := robot_of(recording):
            return _drawn(robot)
        if curves := None if recording.calls or recording.goals else self._curves(recording):
            return {"image/svg+xml": curves}, f"{self.exercise.title}: what your node does, and what the solution does"
        drawn = lanes(events_of(recording))
        if not any(lane.marks for lane in drawn):
            return {}, ""
        svg = timeline_svg(drawn, self.exercise.title, moves=False)
        return {"image/svg+xml": svg}, in_words(drawn, span_of(drawn)[0])

    def _curves(self, recording: Recording) -> str | None:
        name, exercise = self.scenario.name, self.exercise
        known = {} if exercise.solution_folder else read_public(exercise).references
        references = {name: known.get(name, Recording(name, (), (), (), (), False, recording.ending))}
        empty = Grade(exercise.name, "", "", "graded", "", 0.0, 0.0, (), "", 1, {})
        grade = replace(empty, recordings={name: recording}, references=references)
        return scenario_picture(grade, exercise, name, judged=False)


@functools.lru_cache(maxsize=1)
def _drawn(robot: RobotDescription) -> tuple[dict[str, Any], str]:
    """Return a robot as a PNG and in words."""
    return {"image/png": still.as_png(robot, {})}, drawing.in_words(robot, {})
