"""Runs one program through all scenarios: several at once, with help from idle workers."""

from __future__ import annotations

import contextlib
import os
import threading
from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from pathlib import Path

from grader.checking.verdict import Verdict
from grader.exercise.exercise import Exercise
from grader.grading.grade import Options
from grader.recording.recording import Recording, not_run_because
from grader.sandbox.program import Isolation, ProgramSpec
from grader.scenario.command_line import ARGUMENTS, arguments, programs_of
from grader.scenario.scenario import Companion, Scenario
from grader.submission.submission import Submission
from grader.workers.jobs import JudgeJob, RunJob
from grader.workers.pool import STUDENT_ENVIRONMENT, WorkerPool
from grader.workers.shared import Sandbox


class TaskQueue:
    """Runs that may be done in any order and at the same time. Any thread may call any method."""

    def __init__(self, jobs: Sequence[RunJob], workers: WorkerPool) -> None:
        """Queue `jobs`; the first one is started first."""
        self._workers = workers
        self._waiting = deque(jobs)
        self._recordings: dict[str, Future[Recording]] = {job.scenario.name: Future() for job in jobs}
        self._given_up = threading.Event()

    @property
    def left(self) -> int:
        """Return how many have not been started yet."""
        return len(self._waiting)

    def work(self, core: int | None = None) -> None:
        """Do one run after another, in one process, until none is left to start.

        `core` is the CPU to keep the program on, None for the one that each job names. An error in a run is raised when
        its recording is requested.
        """
        with self._workers.reserve() as worker:
            while job := self._next():
                recording = self._recordings[job.scenario.name]
                try:
                    recording.set_result(worker.do(job if core is None else replace(job, core=core), self._given_up))
                except BaseException as fault:
                    recording.set_exception(fault)

    def _next(self) -> RunJob | None:
        try:
            return self._waiting.popleft()
        except IndexError:
            return None

    def recording(self, scenario: str) -> Recording:
        """Wait for the recording of a scenario, and return it. Raises `HostFault` when there is none."""
        return self._recordings[scenario].result()

    def give_up(self) -> None:
        """Start no further runs, and end those in progress."""
        self._waiting.clear()
        self._given_up.set()


class WorkStealing:
    """Lets idle workers help those with a long queue. Any thread may call any method."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._under_way: list[TaskQueue] = []
        self._closed = False

    @contextlib.contextmanager
    def wanted(self, queue: TaskQueue) -> Iterator[None]:
        """Let idle workers help with these runs inside the `with` block."""
        with self._changed:
            self._under_way.append(queue)
            self._changed.notify_all()
        try:
            yield
        finally:
            with self._changed:
                self._under_way.remove(queue)

    def help(self, core: int | None) -> None:
        """Help the longest queue, with the program on CPU `core`. Return once this is closed."""
        while self._help_with_one(core):
            pass

    def _help_with_one(self, core: int | None) -> bool:
        queue = self._neediest()
        if queue:
            queue.work(core)
        return queue is not None

    def _neediest(self) -> TaskQueue | None:
        with self._changed:
            self._changed.wait_for(lambda: self._closed or any(queue.left for queue in self._under_way))
            return None if self._closed else max(self._under_way, key=lambda queue: queue.left)

    def close(self) -> None:
        """Release all helpers."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()


#: What a submission may publish in all scenarios together, and the least that each scenario gets of it (bytes). As
#: Python objects, in the grader's memory, it takes about ten times as much.
MOST_BYTES, LEAST_BYTES = 24_000_000, 1_000_000

#: What reading all that a submission sends may cost the grader, in all scenarios together; the least that each scenario
#: gets of it; and more for each message of the scenario (CPU seconds). The course's solutions need 0.1 s a scenario.
HUB_CPU_S, LEAST_HUB_CPU_S, HUB_CPU_S_PER_MESSAGE = 10.0, 1.0, 0.002

#: The same for what the submission itself computes. The course's solutions need 0.1 s per scenario; the least is more
#: than a program may take to start.
CPU_S, LEAST_CPU_S, CPU_S_PER_MESSAGE = 100.0, 10.0, 0.001


@dataclass(frozen=True)
class ScenarioRunner:
    """Runs submissions of one exercise through its scenarios, at one level of isolation."""

    exercise: Exercise
    scenarios: tuple[Scenario, ...]
    isolation: Isolation
    options: Options
    workers: WorkerPool
    work_stealing: WorkStealing = field(default_factory=WorkStealing, compare=False)
    """Lets idle workers help the `options.parallel` workers of each submission."""
    partly: bool = False
    """Whether only the checks judge that need no other scenarios than those that were run."""
    needed: frozenset[str] = frozenset()
    """The scenarios to run after the first; if empty, all are run. A program's limits are the same."""

    def run(self, submission: Submission) -> dict[str, Recording]:
        """Return the recording of each scenario that is run. Raises `HostFault` when there is none.

        The first scenario decides whether the program works at all; if it does not, no other is run, and every
        recording ends as that one does.
        """
        jobs = [
            self.job(submission, scenario, i)
            for i, scenario in enumerate(self.scenarios)
            if i == 0 or not self.needed or scenario.name in self.needed
        ]
        # The first scenario is needed at once. Then the longest ones start first, so that none is left over at the end.
        queue = TaskQueue((jobs[0], *sorted(jobs[1:], key=lambda job: -job.scenario.size)), self.workers)
        with ThreadPoolExecutor(self.options.parallel) as pool, self.work_stealing.wanted(queue):
            for _ in range(self.options.parallel):
                pool.submit(queue.work)
            try:
                first = queue.recording(self.scenarios[0].name)
                if first.ending.outcome != "completed":
                    return {scenario.name: not_run_because(first, scenario.name) for scenario in self.scenarios}
                self.workers.prepare_to_judge()
                return {job.scenario.name: queue.recording(job.scenario.name) for job in jobs}
            finally:
                queue.give_up()

    def judge(self, recordings: dict[str, Recording], references: dict[str, Recording]) -> tuple[Verdict, ...]:
        """Return the verdicts on a submission's recordings, by scenario. Raises `HostFault` when there are none."""
        titles = {scenario.name: scenario.title for scenario in self.scenarios}
        job = JudgeJob(self.exercise, recordings, references, titles, self.options.seed, self.partly)
        return self.workers.judge(job)

    def share(self, references: Iterable[Recording] = ()) -> None:
        """Give the worker what all jobs need. Call this once, before the first submission."""
        sandbox = Sandbox((), self._hidden, self.options.limits.file_bytes)
        self.workers.share([self.exercise, *self.scenarios, *references, sandbox])

    @property
    def _hidden(self) -> tuple[Path, ...]:
        """Return the folders that no submission may see, wherever they are on this machine."""
        return self.exercise.folder, *([self.exercise.solution_folder] if self.exercise.solution_folder else [])

    def only(self, scenario: str) -> ScenarioRunner:
        """Return the same runner with a single scenario."""
        return replace(self, scenarios=tuple(s for s in self.scenarios if s.name == scenario))

    def _share(self, together: float, least: float) -> float:
        """Return one scenario's part of what all scenarios may take together."""
        return max(least, together / len(self.scenarios))

    def job(self, submission: Submission, scenario: Scenario, number: int) -> RunJob:
        """Return the run of a program through one scenario; `number` chooses its core, in turn."""
        assert submission.program
        program = replace(
            submission.program,
            arguments=arguments(scenario),
            environment={**STUDENT_ENVIRONMENT, **submission.program.environment},
            hidden=self._hidden,
        )
        main = "" if self.exercise.programs else program.main
        programs = {
            one.id: replace(program, main=main or one.file, arguments=arguments(scenario, one))
            for one in programs_of(self.exercise, scenario)
        }
        cores = sorted(os.sched_getaffinity(0))
        limits, size = self.options.limits, scenario.size
        cpu_s = self._share(CPU_S, LEAST_CPU_S) + CPU_S_PER_MESSAGE * size
        return RunJob(
            exercise=self.exercise,
            scenario=scenario,
            program=program,
            isolation=self.isolation,
            limits=replace(limits, cpu_s=min(limits.cpu_s, cpu_s)),
            source=submission.source,
            file_name=submission.file_name,
            core=cores[number % len(cores)] if self.options.core is None else self.options.core,
            pace=self.options.pace,
            data_bytes=int(self._share(MOST_BYTES, LEAST_BYTES)),
            hub_cpu_s=self._share(HUB_CPU_S, LEAST_HUB_CPU_S) + HUB_CPU_S_PER_MESSAGE * size,
            programs=programs,
            companions=tuple(_companion(companion) for companion in scenario.companions),
        )


def _companion(companion: Companion) -> ProgramSpec:
    return ProgramSpec(
        companion.file,
        {name: text.encode() for name, text in {**companion.modules, companion.file: companion.text}.items()},
        (*companion.arguments, *ARGUMENTS),
        STUDENT_ENVIRONMENT,
    )
