"""Runs one student's program through one scenario, over the grader's own middleware.

The hub sets the time, hands the program each message, and knows when the program has nothing left to do. So the
recording depends on the program alone.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from grader.recording.recording import Ending, Endpoint, ReceivedMessage, Recording
from grader.runner.budget import Allowance, Budget, ProgramExited
from grader.runner.grader_side import Clocks, GraderSide, clock_message, nanoseconds
from grader.runner.graph import end_points, nodes
from grader.runner.program import CannotContinue, RunningProgram, Task
from grader.runner.program_end import cut_short, interrupted, message_of_violation, survived_by
from grader.runner.publishers import OFFER, ReferencePublishers
from grader.runner.readiness import START as STARTING
from grader.runner.readiness import Parameters, wait_until_up
from grader.runner.recorder import Recorder, recorded_topics
from grader.runner.script import AFTERWARDS, Script
from grader.runner.team import Start, Team
from grader.scenario.command_line import starts
from grader.scenario.scenario import SECOND, START, Content, Message
from rmw_lockstep.hub import Hub, HubLimits, Violation

#: A program that waits for less than this is considered about to continue (ns of the computer's time).
SOON = 3 * SECOND

ENDLESS = "Your node used {0:g} s of computing time on one message and did not finish. Is there an endless loop?"
OUTSIDE = (
    "Your program did not go on for {0:g} s: it waits for something outside it, such as another program that sleeps."
)
UNRESPONSIVE = (
    "Your node started but never responds. Does your program call rclpy.spin(node), and does no callback wait or sleep?"
)

STEP = Allowance(ENDLESS.format(3.0), OUTSIDE.format(3.0))


def run(
    task: Task,
    start: Start,
    limits: HubLimits | None = None,
    programs: Mapping[str, Start] | None = None,
    companions: Sequence[Start] = (),
) -> Recording:
    """Start the student's program and run it through the scenario; every fault of the program is in the recording.

    `start` gets the socket that the program inherits, through which each of its processes has to connect to the hub
    before it runs any of the student's code. A submission of several programs has `programs` instead, by their files;
    `companions` are the author's own.

    Raises `ExerciseError` if the author has something to fix; any other exception is a fault of the machine or of
    ours.
    """
    began = time.monotonic()
    with Hub(limits=limits) as hub:
        student: RunningProgram
        if programs or companions:
            student = Team(hub, task, programs or {task.file_name: start}, companions)
        else:
            student = start(hub.add_program())
        try:
            return ScenarioRun(task, student, hub).run(began)
        finally:
            student.kill()


class ScenarioRun:
    """One run: the grader's endpoints around one program."""

    def __init__(self, task: Task, student: RunningProgram, hub: Hub) -> None:
        self._task, self._student, self._hub = task, student, hub
        runner = hub.node("runner")
        self._clock = runner.publisher("/clock", "rosgraph_msgs/msg/Clock", OFFER)
        self._team = student if isinstance(student, Team) else None
        earliest = 0 if task.scenario.is_filter else START
        self._recorder = Recorder(runner, recorded_topics(task), earliest, self._is_ours)
        reference = hub.node(task.exercise.reference_node)
        self._publishers = ReferencePublishers(reference, task.scenario)
        self._parameters = Parameters(hub, runner)
        self._budget = Budget(student, self._pids, STARTING)
        self._clocks = Clocks(task.scenario.computer_time)
        self._script: Script | None = None
        if not task.scenario.is_filter:
            ends = GraderSide(hub, reference, self._clocks)
            self._script = Script(ends, task, self._publishers, self._recorder, self._publish, self._team)
        for message in task.scenario.messages:
            if message.at < START:
                self._publishers.publish(message)
        self._is_up = False
        self._nodes: tuple[str, ...] = ()
        self._end_points: tuple[Endpoint, ...] = ()
        self._sim_time = False
        self._asks_in_vain = False
        self._lockstep_seconds = 0.0
        hub.main = None if self._team else student.pid
        hub.on_tick = self._budget.look
        hub.before_end = self._remember_end_points

    def _pids(self) -> set[int]:
        return {link.pid for link in self._hub.links}.union(self._student.pids())

    def _is_ours(self, process: int) -> bool:
        """Return whether a process is one of the author's companions."""
        return self._team is not None and self._team.is_companions(process)

    def _remember_end_points(self) -> None:
        """Remember endpoints and nodes before a program ends, because they may be gone by its end."""
        found = end_points(self._hub.graph, self._is_ours)
        if len(found) >= len(self._end_points):
            self._end_points = found
        if self._team and self._is_up:
            self._remember_nodes()

    def _remember_nodes(self) -> None:
        self._nodes = tuple(sorted({*self._nodes, *nodes(self._hub.graph, self._is_ours)}))

    def run(self, began: float) -> Recording:
        """Do the whole run, from the program's start to its end."""
        ending = self._ending()
        self._end_points = self._end_points or end_points(self._hub.graph, self._is_ours)
        self._student.kill()  # before taking the last messages: it may never stop publishing
        ending, received = self._take_everything(ending)
        return Recording(
            scenario=self._task.scenario.name,
            sent=tuple(self._publishers.sent),
            received=received,
            nodes=self._nodes,
            end_points=self._end_points,
            uses_sim_time=self._sim_time,
            ending=ending,
            log=self._student.output(),
            seconds=time.monotonic() - began,
            lockstep_seconds=self._lockstep_seconds,
            **self._of_the_script(),
        )

    def _of_the_script(self) -> dict[str, Any]:
        script = self._script
        if script is None:
            return {}
        return {
            **script.recorded(),
            "exits": tuple(self._team.exits) if self._team else (),
            "programs": starts(self._task.exercise, self._task.scenario),
        }

    def _ending(self) -> Ending:
        task, sources = self._task, self._task.sources
        try:
            self._begin()
            began = time.monotonic()
            if self._script:
                self._carry_out(self._script)
            else:
                self._lockstep()
            self._lockstep_seconds = time.monotonic() - began
            survived = survived_by(self._student.output(), sources)
            ending = Ending("completed")
            if task.scenario.interrupt:
                ending = interrupted(self._hub, self._budget, self._student, sources)
            return replace(ending, survived=survived)
        except CannotContinue as stopped:
            return Ending(stopped.outcome, stopped.message)
        except Violation as violation:
            return Ending("over-limit", message_of_violation(violation))
        except ProgramExited:
            self._check_that_it_was_the_program()
            return cut_short(self._student, sources, self._is_up, self._when() if self._is_up else "before the start")

    def _when(self) -> str:
        """Return the current moment, in words."""
        if self._script is None or not self._is_up:
            return f"at message {len(self._publishers.sent)}"
        return f"{(self._clocks.at - START) / SECOND:.2f} s after the start"

    def _check_that_it_was_the_program(self) -> None:
        """Raise if the machine ended the program."""
        exit_ = self._student.poll()
        if exit_ and exit_.limit == "wall":
            self._budget.check_the_host()

    def _take_everything(self, ending: Ending) -> tuple[Ending, tuple[ReceivedMessage, ...]]:
        """Return everything that the program published, and the ending, which changes if that exceeds a limit."""
        try:
            self._hub.drain()
        except Violation as violation:
            ending = _first(ending, Ending("over-limit", message_of_violation(violation)))
        except CannotContinue as stopped:
            ending = _first(ending, Ending(stopped.outcome, stopped.message))
        try:
            received = self._recorder.received(self._clocks, self._publishers.stages)
        except CannotContinue as stopped:
            return _first(ending, Ending(stopped.outcome, stopped.message)), ()
        return ending, received

    def _begin(self) -> None:
        hub = self._hub
        wait_until_up(hub, lambda: self._publishers.have_subscribers, lambda: bool(nodes(hub.graph, self._is_ours)))
        self._budget.begin(STEP)
        self._sim_time = self._parameters.use_sim_time(hub.now + SOON)
        self._nodes = nodes(hub.graph, self._is_ours)
        self._is_up = self._script is not None  # timers fire as soon as there is a clock
        self._set_clock(START)
        hub.wait_until_idle()
        self._is_up = True
        self._remember_end_points()

    def _lockstep(self) -> None:
        began = time.monotonic()
        for message in self._task.scenario.messages:
            self._budget.begin(self._allowance(message.at))
            self._keep_pace(began, message.at)
            self._go_to(message.at)
            self._publish(message)
            self._hub.wait_until_idle()
            self._check_that_it_listens(message)
        self._end_points = end_points(self._hub.graph, self._is_ours)
        self._go_to(self._clocks.at + AFTERWARDS)
        self._hub.wait_until_idle()
        self._check_that_it_still_answers()

    def _publish(self, message: Message) -> None:
        if not self._publishers.has_subscriber(message):
            self._hub.wait_until_idle()  # before that, the program's subscriptions are not known
        self._clocks.set(message.at, self._hub.now, self._publishers.publish(message), message=True)

    def _carry_out(self, script: Script) -> None:
        """Let time pass to the end, at the scenario's rate, and publish and do each step at its time."""
        scenario, began = self._task.scenario, time.monotonic()
        content = deque(one for one in scenario.content if one.at >= START)
        end = (
            START + nanoseconds(scenario.duration)
            if scenario.duration
            else START + nanoseconds(scenario.seconds) + AFTERWARDS
        )
        ticks = 0
        self._settle(script)
        while self._clocks.at < end or content:
            tick = START + round((ticks + 1) * SECOND / scenario.clock_rate)
            at = min(one for one in (tick, content[0].at if content else None, script.due, max(end, START)) if one)
            at = max(at, self._clocks.at)
            ticks += at >= tick
            self._budget.begin(self._allowance(at))
            self._keep_pace(began, at)
            self._go_to(at)
            while content and content[0].at <= at:
                self._do(content.popleft(), script)
            self._settle(script)
        self._end_points = self._all_end_points()
        self._remember_nodes()
        if not scenario.servers:
            self._check_that_it_still_answers()

    def _all_end_points(self) -> tuple[Endpoint, ...]:
        """Return the current end points; with several programs, also those of one that was killed."""
        found = end_points(self._hub.graph, self._is_ours)
        if not self._team:
            return found
        gone = {*self._end_points}.difference(found)
        return tuple(sorted((*found, *gone), key=lambda one: (one.topic, one.kind, one.node)))

    def _do(self, one: Content, script: Script) -> None:
        if isinstance(one, Message):
            self._publish(one)
        else:
            self._hub.wait_until_idle()
            script.do(one)

    def _settle(self, script: Script) -> None:
        """Wait until neither the program nor the grader's side has anything left to do."""
        self._hub.wait_until_idle()
        while script.act(self._clocks.at):
            self._hub.wait_until_idle()

    def _allowance(self, at: int) -> Allowance:
        """Return the allowance until simulated time `at`: the program may compute for as long as time passes."""
        passes = (self._clocks.computer(at) - self._hub.now) / SECOND
        return STEP if passes < 1.0 else replace(STEP, cpu_s=STEP.cpu_s + passes)

    def _go_to(self, at: int) -> None:
        """Advance both clocks to the simulated time `at`, after doing everything that is due before."""
        self._hub.advance(self._clocks.computer(at))
        if at > self._clocks.at:
            self._set_clock(at)
        self._hub.barrier()

    def _set_clock(self, at: int) -> None:
        self._clocks.set(at, self._hub.now, self._clock.publish(clock_message(at)))

    def _check_that_it_listens(self, message: Message) -> None:
        """Raise `CannotContinue` if the program neither waits in ROS 2 nor will continue soon, nor answers a call."""
        hub = self._hub
        if hub.in_ros or self._asks_in_vain or not self._publishers.has_subscriber(message):
            return
        wakes = hub.next
        if wakes is not None and wakes - hub.now <= SOON:
            return
        self._ask(until=hub.now)
        self._asks_in_vain = True  # an executor with its own way of waiting, such as rclpy's EventsExecutor

    def _check_that_it_still_answers(self) -> None:
        """Raise `CannotContinue` if the program has answered no message by the end, does not wait in ROS 2, and answers
        no call in the next seconds: for example because it keeps reading the clock.
        """
        subscribed = [
            stage for stage, sent in zip(self._publishers.stages, self._publishers.sent, strict=True) if sent.heard
        ]
        if subscribed and not self._hub.in_ros and not self._recorder.has_received_since(subscribed[-1]):
            with self._recorder.paused():
                self._ask(until=self._hub.now + SOON)

    def _ask(self, until: int) -> None:
        if not all(self._parameters.answers(node, until) for node in self._nodes):
            raise CannotContinue("timed-out", UNRESPONSIVE)

    def _keep_pace(self, began: float, at: int) -> None:
        if self._task.pace:
            due = began + (at - START) / SECOND / self._task.pace
            time.sleep(max(0.0, due - time.monotonic()))


def _first(ending: Ending, other: Ending) -> Ending:
    """Return the first of both endings; a completed run ends with the `other`."""
    return other if ending.outcome == "completed" else ending
