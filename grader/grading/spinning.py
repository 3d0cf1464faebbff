"""Spins one program through all scenarios: several at once, each hand one after another."""

from __future__ import annotations

import json
import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from typing import Any

from grader.crew import Crew
from grader.crew.environment import FAST_DDS, PROFILE, STUDENTS
from grader.crew.jobs import SpinJob
from grader.exercise import Exercise
from grader.grading.helping import Helping
from grader.grading.options import Options
from grader.grading.spins import Spins
from grader.recording import Ending, Recording
from grader.sandbox import Isolation, Middleware, MiddlewareUnavailable, Program, choose_middleware
from grader.scenario import Companion, Scenario
from grader.submission import Submission

#: How every program is started.
ARGUMENTS = ("--ros-args", "-p", "use_sim_time:=true")

#: What a submission may publish in all scenarios together (bytes), of which each gets an equal part, but not less than
#: this. As Python's objects, in the memory of the grader, it takes about ten times as much.
MOST_BYTES, LEAST_BYTES = 24_000_000, 1_000_000


@dataclass(frozen=True)
class Spinner:
    """Spins submissions of one exercise through its scenarios, at one level of isolation."""

    exercise: Exercise
    scenarios: tuple[Scenario, ...]
    isolation: Isolation
    options: Options
    crew: Crew
    helping: Helping = field(default_factory=Helping, compare=False)
    """Through which others may help, beside the `options.parallel` hands that there are for each submission."""

    @property
    def middleware(self) -> Middleware:
        """Over which programs talk. Raises `MiddlewareUnavailable` where the one that is asked for can't be had."""
        middleware = choose_middleware(self.options.middleware).middleware
        beyond = next((one for one in self.scenarios if not one.is_filter), None)
        if middleware is Middleware.FASTDDS and beyond:
            told = (
                f"The scenario {beyond.name} does more than publish messages, which the middleware 'fastdds' can't do."
            )
            raise MiddlewareUnavailable(f"{told} Grade this exercise with --middleware lockstep.")
        return middleware

    def spin(self, submission: Submission) -> dict[str, Recording]:
        """The recording of each scenario. Raises `HostFault` when one can't be had.

        The first scenario decides whether the program works at all; if it does not, nothing else is spun, and every
        recording ends as that one does.
        """
        jobs = [self.job(submission, scenario, i) for i, scenario in enumerate(self.scenarios)]
        # The longest first, so that none is left over at the end; the very first is needed at once.
        spins = Spins((jobs[0], *sorted(jobs[1:], key=lambda job: -len(job.scenario.messages))), self.crew)
        with ThreadPoolExecutor(self.options.parallel) as pool, self.helping.wanted(spins):
            for _ in range(self.options.parallel):
                pool.submit(spins.work)
            try:
                first = spins.recording(self.scenarios[0].name)
                if first.ending.outcome != "completed":
                    return {scenario.name: _likewise(first, scenario) for scenario in self.scenarios}
                self.crew.prepare_to_judge()
                return {scenario.name: spins.recording(scenario.name) for scenario in self.scenarios}
            finally:
                spins.give_up()

    def only(self, scenario: str) -> Spinner:
        """The same, with one scenario alone."""
        return replace(self, scenarios=tuple(s for s in self.scenarios if s.name == scenario))

    def job(self, submission: Submission, scenario: Scenario, number: int) -> SpinJob:
        """The spin of a program through one scenario; `number` chooses the core that it is kept on, turn by turn."""
        assert submission.program
        fast_dds = self.middleware is Middleware.FASTDDS
        program = replace(
            submission.program,
            arguments=arguments(scenario),
            environment={**STUDENTS, **(FAST_DDS if fast_dds else {}), **submission.program.environment},
            readonly=(*((PROFILE,) if fast_dds else ()), *submission.program.readonly),
            hidden=(self.exercise.folder, *([self.exercise.solution_folder] if self.exercise.solution_folder else [])),
        )
        own = {one.file: one.arguments for one in scenario.programs}
        programs = tuple(
            replace(program, main=one.file, arguments=(*own.get(one.file, ()), *program.arguments))
            for one in self.exercise.programs
        )
        cores = sorted(os.sched_getaffinity(0))
        return SpinJob(
            exercise=self.exercise,
            scenario=scenario,
            program=program,
            isolation=self.isolation,
            middleware=self.middleware,
            limits=self.options.limits,
            source=submission.source,
            file_name=submission.file_name,
            core=cores[number % len(cores)] if self.options.core is None else self.options.core,
            pace=self.options.pace,
            data_bytes=max(LEAST_BYTES, MOST_BYTES // len(self.scenarios)),
            programs=programs,
            companions=tuple(_companion(one) for one in scenario.companions),
        )


def _likewise(first: Recording, scenario: Scenario) -> Recording:
    if first.scenario == scenario.name:
        return first
    return Recording(
        scenario.name, (), (), first.nodes, (), "none", False, Ending(first.ending.outcome, first.ending.story)
    )


def _companion(one: Companion) -> Program:
    return Program(one.file, {one.file: one.text.encode()}, (*one.arguments, *ARGUMENTS), STUDENTS)


def arguments(scenario: Scenario) -> tuple[str, ...]:
    """What follows the program's name on its command line in a scenario."""
    found = [*scenario.arguments, *ARGUMENTS]
    for name, value in scenario.parameters.items():
        found += ["-p", f"{name}:={_yaml(value)}"]
    for name, to in scenario.remappings.items():
        found += ["-r", f"{name}:={to}"]
    if scenario.namespace:
        found += ["-r", f"__ns:={scenario.namespace}"]
    return tuple(found)


def _yaml(value: Any) -> str:
    """A parameter's value on a command line, such as `2.0`, `true` or `["a", "b"]`."""
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(_yaml(one) for one in value)}]"
    if isinstance(value, float):
        text = repr(value)
        special = {"nan": ".nan", "inf": ".inf", "-inf": "-.inf"}
        # A number with an exponent needs a point to be one in YAML 1.1.
        return special.get(text, text if "." in text or "e" not in text else text.replace("e", ".0e"))
    return json.dumps(value)
