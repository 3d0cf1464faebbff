"""The second opinion: every file of an exercise's solutions, graded over both middlewares.

The grader's own middleware (rmw_lockstep) decides; Fast DDS is what robots use. Where the two lead to different
verdicts, one of them is wrong, or the program depends on something that Fast DDS leaves to chance.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

from grader.audit.candidates import Candidate, mistakes, right_ones
from grader.audit.result import Differing, Opinion, Progress, Shadow
from grader.checking.verdict import Verdict
from grader.exercise.exercise import Exercise
from grader.grading.grade import Grade, Options
from grader.grading.grading import Grading, grading_of
from grader.recording.recording import Recording
from grader.sandbox.program import Middleware
from grader.workers.pool import HostFault, WorkerPool

#: What is compared besides the checks.
OUTCOME = "outcome"

INFERRED = "over Fast DDS the grader could only infer from sleeping threads when the node was done"

CALLED = (
    "over Fast DDS the grader has to call a service of each node to know that it is done, "
    "and a node that the program creates but never spins does not answer"
)

PILED_UP = (
    "over Fast DDS messages follow one another at once while a sleep takes real time, "
    "so answers from a thread that sleeps pile up, and a publisher keeps only as many as its queue depth"
)


def shadow(exercise: Exercise, options: Options, workers: WorkerPool, progress: Progress) -> Shadow:
    """Grade every file of the exercise's solutions over both middlewares, and compare.

    Raises what `grading_of` raises, `MiddlewareUnavailable` if one is not available, and `HostFault` if a program can't
    be graded because of a fault of the machine or the grader.
    """
    began = time.monotonic()
    gradings = [grading_of(exercise, replace(options, middleware=one), workers) for one in Middleware]
    programs = [*right_ones(exercise), *mistakes(exercise)]
    progress.begin(exercise.name, len(programs))
    with ThreadPoolExecutor(options.parallel) as pool:
        compared = [pool.submit(_compared, program, gradings, progress) for program in programs]
        found = [one for future in compared for one in future.result()]
    differing = tuple(one for one in found if one.lockstep.verdict != one.fast_dds.verdict)
    equal = len(found) - len(differing)
    return Shadow(exercise.name, exercise.title, len(programs), equal, differing, time.monotonic() - began)


def _compared(program: Candidate, gradings: list[Grading], progress: Progress) -> list[Differing]:
    lockstep, fast_dds = (_graded(program, grading) for grading in gradings)
    progress.done()
    return list(_verdicts(program.name, lockstep, fast_dds))


def _graded(program: Candidate, grading: Grading) -> Grade:
    runner = grading.runner
    one_at_a_time = replace(runner, options=replace(runner.options, parallel=1))
    grade = replace(grading, runner=one_at_a_time).grade(program.submission)
    if grade.outcome == "host-error":
        raise HostFault(f"{program.file} can't be graded over {runner.middleware}: {grade.message}")
    return grade


def _verdicts(program: str, lockstep: Grade, fast_dds: Grade) -> Iterator[Differing]:
    ours, theirs = (Opinion(grade.outcome, grade.message) for grade in (lockstep, fast_dds))
    first = next(iter(lockstep.recordings), "")
    yield Differing(program, OUTCOME, ours, theirs, _reason(lockstep, fast_dds, first))
    others = {verdict.name: verdict for verdict in fast_dds.verdicts}
    for verdict in lockstep.verdicts:
        other = others[verdict.name]
        scenario = next((one.finding.scenario for one in (verdict, other) if one.finding), "")
        why = _reason(lockstep, fast_dds, scenario)
        yield Differing(program, verdict.name, _opinion(verdict), _opinion(other), why)


def _opinion(verdict: Verdict) -> Opinion:
    return Opinion(verdict.status, verdict.finding.text if verdict.finding else "")


def _reason(lockstep: Grade, fast_dds: Grade, scenario: str) -> str:
    """Why the two differ, as far as the recordings show it: those of the finding's scenario, or of the first to differ.

    A check that could not be judged, because another one failed, has no finding.
    """
    scenarios = [scenario] if scenario else list(lockstep.recordings)
    reasons = (_explained(one, lockstep.recordings.get(one), fast_dds.recordings.get(one)) for one in scenarios)
    return next(filter(None, reasons), "")


def _explained(scenario: str, ours: Recording | None, theirs: Recording | None) -> str:
    if ours is None or theirs is None:
        return ""
    seen = _seen(ours, theirs)
    return "; ".join(filter(None, (f"scenario {scenario}: {seen}" if seen else "", _limit(ours, theirs))))


def _limit(ours: Recording, theirs: Recording) -> str:
    """The limit of grading over Fast DDS that can have made these two differ."""
    if theirs.synchronization == "idle":
        return INFERRED
    if theirs.ending.outcome == "timed-out" and len(theirs.nodes) > 1:
        return CALLED
    lost = ours.ending.outcome == theirs.ending.outcome and len(theirs.received) < len(ours.received)
    return PILED_UP if lost else ""


def _seen(ours: Recording, theirs: Recording) -> str:
    """The first difference between two recordings of one scenario."""
    if ours.ending.outcome != theirs.ending.outcome:
        return f"its run is {ours.ending.outcome} over lockstep, {theirs.ending.outcome} over Fast DDS"
    heard = [sum(sent.heard for sent in recording.sent) for recording in (ours, theirs)]
    if heard[0] != heard[1]:
        return f"it subscribed to {heard[0]} of {len(ours.sent)} messages over lockstep, to {heard[1]} over Fast DDS"
    if len(ours.received) != len(theirs.received):
        return f"it published {len(ours.received)} messages over lockstep and {len(theirs.received)} over Fast DDS"
    for number, (one, other) in enumerate(zip(ours.received, theirs.received, strict=True), start=1):
        if one.fields != other.fields:
            return f"its message {number} is another one"
        if one.after != other.after:
            return f"its message {number} came after input {one.after} over lockstep, after {other.after} over Fast DDS"
    return ""
