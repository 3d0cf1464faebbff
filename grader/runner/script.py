"""Carries out a scenario's steps besides messages: services, actions, parameters and worlds."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from grader.exercise.exercise import ExerciseError
from grader.exercise.imported_files import place_of
from grader.runner.action_clients import CancelStep, Goals
from grader.runner.action_servers import ScriptedActionServer
from grader.runner.calls import Calls, CallStep
from grader.runner.grader_side import GraderSide, Schedule, hub_qos, nanoseconds
from grader.runner.program import AuthorFault, Task
from grader.runner.publishers import ReferencePublishers
from grader.runner.recorder import Recorder
from grader.runner.running_world import RunningWorld
from grader.runner.service_servers import ServiceServer, unserved
from grader.runner.team import Team
from grader.scenario.scenario import (
    SECOND,
    START,
    ComeBack,
    Kill,
    Leave,
    Message,
    Program,
    SendGoal,
    StartProgram,
    Step,
    Subscribe,
    ToWorld,
)
from grader.scenario.servers import ActionServer
from grader.scenario.servers import Server as DeclaredServer

#: How long simulated time continues after the last message, for what a node does by timer (ns).
AFTERWARDS = SECOND // 2

Peer = ServiceServer | ScriptedActionServer


class Script:
    """The grader's side of one scenario; `publish` publishes a world's message."""

    def __init__(
        self,
        ends: GraderSide,
        task: Task,
        publishers: ReferencePublishers,
        recorder: Recorder,
        publish: Callable[[Message], None],
        team: Team | None = None,
    ) -> None:
        scenario = task.scenario
        self._ends, self._task = ends, task
        self._publishers, self._recorder, self._team = publishers, recorder, team
        self._schedule = Schedule()
        self._calls = Calls(ends, scenario)
        self._goals = Goals(ends, scenario)
        self._world: RunningWorld | None = None
        self._servers: dict[str, Peer] = {}
        for one in scenario.programs:
            self._plan_program(one)
        for declared in scenario.servers:
            self._add(declared)
        if scenario.world:
            self._world = RunningWorld(ends, self._schedule, scenario.world, publishers, publish)

    def _plan_program(self, one: Program) -> None:
        team = self._team
        assert team
        if one.starts > 0:
            self._schedule.plan(START + nanoseconds(one.starts), lambda now: team.start(one.id))
        if one.killed is not None:
            self._schedule.plan(START + nanoseconds(one.killed), lambda now: team.stop(one.id, now))

    def _add(self, declared: DeclaredServer | ActionServer) -> None:
        peer: Peer
        if isinstance(declared, ActionServer):
            peer = ScriptedActionServer(self._ends, self._schedule, declared)
        else:
            peer = ServiceServer(self._ends, self._schedule, declared)
        self._servers[peer.name] = peer
        for seconds, act in ((declared.appears, peer.open), (declared.gone, peer.close), (declared.back, peer.open)):
            if seconds is not None:
                self._schedule.plan(START + nanoseconds(seconds), lambda now, act=act: act())  # type: ignore[misc]
        if declared.appears is None:
            peer.open()

    @property
    def due(self) -> int | None:
        """The time of the next scheduled action that is not a step (ns of simulated time)."""
        return self._schedule.due

    def do(self, step: Step) -> None:
        """Carry out one step."""
        if isinstance(step, CallStep):
            self._calls.make(step)
        elif isinstance(step, SendGoal):
            self._goals.send(step)
        elif isinstance(step, CancelStep):
            self._goals.cancel(step)
        elif isinstance(step, Subscribe):
            self._recorder.join(step.name, step.topic, step.type, hub_qos(step.qos))
        elif isinstance(step, Leave):
            self._leave(step.name)
        elif isinstance(step, ToWorld) and self._world:
            self._world.do(step)
        elif isinstance(step, Kill) and self._team:
            self._team.stop(step.program, step.at)
        elif isinstance(step, StartProgram) and self._team:
            self._team.start(step.program)
        elif isinstance(step, ComeBack) and step.name in self._servers:
            self._servers[step.name].open()

    def _leave(self, name: str) -> None:
        if name in self._servers:
            self._servers[name].close()
        self._publishers.leave(name)
        self._recorder.leave(name)

    def act(self, now: int) -> bool:
        """Do what is due, and react to what the program did. Return whether there was anything to do."""
        try:
            took = [peer.react(now) for peer in self._servers.values()]
            return any([*took, self._goals.react(now), self._schedule.act(now)])
        except AuthorFault as error:
            scenario, exercise = self._task.scenario, self._task.exercise
            cause = error.__cause__ or error
            place = place_of(cause, exercise.folder) or (exercise.scenarios_file, scenario.line or None)
            found = f"in the scenario {scenario.name}, {error}"
            fix = "Fix it: it runs inside the grader, and a student's node may send it anything that the type allows."
            raise ExerciseError(place[0], found, fix, place[1]) from None

    def recorded(self) -> dict[str, Any]:
        """Return what has happened so far, by the fields of a `Recording`.

        Calls are in the order in which they were made, and goals in that in which they were sent, by whomever.
        """
        calls = [*self._calls.calls(), *unserved(self._ends, self._task.exercise)]
        goals = [*self._goals.goals()]
        for peer in self._servers.values():
            if isinstance(peer, ServiceServer):
                calls += peer.calls()
            else:
                goals += peer.goals()
        return {
            "calls": tuple(sorted(calls, key=lambda call: call.at)),
            "goals": tuple(goals),
            "parameters": self._calls.changes(),
            "readings": self._calls.readings(),
            "truth": tuple(self._world.truth) if self._world else (),
        }
