"""A trial: one program run through the scenarios and judged, as far as its verdict needs."""

from __future__ import annotations

import itertools
import json
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

from grader.audit.result import RecordingDifference, Trial, Until
from grader.audit.store import RecordedRuns
from grader.checking.verdict import Finding, ListedCheck, Status, Verdict, with_dependencies
from grader.grading.grading import Grading
from grader.recording.recording import Ending, ReceivedMessage, Recording, not_run
from grader.scenario.scenario import Scenario
from grader.submission.submission import Submission
from grader.workers.pool import Worker


def differences(recording: Recording, reference: Recording) -> tuple[RecordingDifference, ...]:
    """Return every difference that can be seen from outside a node: messages, graph, how it ended. Its log does not
    count.
    """
    texts: list[str] = []
    if recording.ending != reference.ending:
        texts.append(f"it ended differently: {recording.ending.message or recording.ending.traceback or 'not in time'}")
    if recording.nodes != reference.nodes:
        texts.append(f"nodes {_named(recording.nodes)}, the solution's {_named(reference.nodes)}")
    texts += _ends(recording, reference)
    if recording.uses_sim_time != reference.uses_sim_time:
        texts.append("its clock differs")
    texts += _messages(recording.received, reference.received)
    texts += _events(recording, reference)
    return tuple(RecordingDifference(recording.scenario, text) for text in texts)


def _differs(recording: Recording, reference: Recording) -> bool:
    """Return whether a check may see a difference.

    The depth of a queue counts here. It alone makes no program different, because it may not matter to the task.
    """
    mine, its = (Counter((end, end.depth) for end in ends.end_points) for ends in (recording, reference))
    return mine != its or bool(differences(recording, reference))


def _named(names: tuple[str, ...]) -> str:
    return ", ".join(names) or "none"


def _ends(recording: Recording, reference: Recording) -> list[str]:
    mine, its = Counter(recording.end_points), Counter(reference.end_points)
    words = (("more", mine - its), ("fewer", its - mine))
    return [
        f"one {end.kind} {word}: {end.topic} ({end.type}, {end.reliability}, {end.durability})"
        for word, ends in words
        for end in ends.elements()
    ]


def _messages(mine: tuple[ReceivedMessage, ...], its: tuple[ReceivedMessage, ...]) -> list[str]:
    if len(mine) != len(its):
        return [f"{len(mine)} messages, the solution's {len(its)}"]
    fields: Counter[str] = Counter()
    for message, other in zip(mine, its, strict=True):
        if (message.at_ns, message.after, message.topic) != (other.at_ns, other.after, other.topic):
            fields["when they came"] += 1
        fields.update(name for name in other.fields if _text(message.fields.get(name)) != _text(other.fields[name]))
    return [f"{count} of {len(its)} messages differ in {name}" for name, count in sorted(fields.items())]


def _events(recording: Recording, reference: Recording) -> list[str]:
    """Return the differences in calls, goals, parameters and ends of programs."""
    texts = []
    events: tuple[tuple[str, Sequence[Any], Sequence[Any]], ...] = (
        ("calls of services", recording.calls, reference.calls),
        ("goals", recording.goals, reference.goals),
        ("settings of parameters", recording.parameters, reference.parameters),
        ("readings of parameters", recording.readings, reference.readings),
        ("ends of programs", recording.exits, reference.exits),
    )
    for name, mine, its in events:
        if len(mine) != len(its):
            texts.append(f"{len(mine)} {name}, the solution's {len(its)}")
        elif differ := sum(_text(asdict(a)) != _text(asdict(b)) for a, b in zip(mine, its, strict=True)):
            texts.append(f"{differ} of {len(its)} {name} differ")
    return texts


def _text(value: Any) -> str:
    """Return the value as text: NaN is not equal to itself, but its text is."""
    return json.dumps(value, sort_keys=True)


@dataclass(frozen=True)
class Trials:
    """Everything that trials of one exercise's programs need."""

    grading: Grading
    checks: tuple[ListedCheck, ...]
    runs: RecordedRuns
    _turn: itertools.count[int] = field(default_factory=itertools.count, compare=False)

    def try_(self, submission: Submission, only: tuple[str, ...] = (), until: Until = "the end") -> Trial:
        """Run and judge a program.

        The exercise's first scenario comes first, then the others, the shorter ones before the longer ones. A scenario
        is run only if an unblocked check needs it. That changes no verdict, because a blocked check never looks at its
        recording. With `only`, only these checks count. With `until="a failure"`, the trial ends as soon as a check
        fails, and nothing is known about the checks that were not judged. A program that no check fails runs through
        every scenario. Raises `HostFault` if the machine or the grader is at fault.
        """
        if not submission.program:
            return self._nothing(submission.problem)
        with self.runs.process() as process:
            return self._tried(lambda scenario: self.run(submission, scenario, process), only, until)

    def _tried(self, run: Callable[[Scenario], Recording], only: tuple[str, ...], until: Until) -> Trial:
        first = self.grading.runner.scenarios[0]
        recordings = {first.name: run(first)}
        if recordings[first.name].ending.outcome != "completed":
            return self._broke_off(recordings)
        wanted_checks = with_dependencies(only or (check.name for check in self.checks), self.checks)
        while True:
            verdicts = self._judged_where_different(recordings)
            decided = tuple(check for check in self.checks if set(check.scenarios) <= set(recordings))
            failed = any(verdicts[check.name].status == "failed" for check in decided)
            caught = failed and until == "a failure"
            needed = [] if caught else self._needed(wanted_checks, verdicts, recordings)
            if not needed and not failed and not only:
                needed = [other for other in self._shorter_first() if other.name not in recordings]
            if not needed:
                return self._trial("", recordings, verdicts, decided)
            for scenario in needed[: 1 if until == "a failure" else None]:
                recordings[scenario.name] = run(scenario)

    def _broke_off(self, recordings: dict[str, Recording]) -> Trial:
        """Return the trial of a program that does not complete the first scenario: it was run in no other."""
        [first] = recordings.values()
        ending = Ending(first.ending.outcome, first.ending.message)
        every = not_run(self.grading.references, ending) | recordings
        return self._trial(first.ending.message, recordings, self._judged(every), self.checks)

    def _shorter_first(self) -> list[Scenario]:
        return sorted(self.grading.runner.scenarios, key=lambda scenario: scenario.seconds)

    def judge(self, recordings: dict[str, Recording], references: dict[str, Recording]) -> dict[str, Verdict]:
        """Return the verdicts on these recordings, by check."""
        verdicts = self.grading.runner.judge(recordings, references)
        return {verdict.name: verdict for verdict in verdicts}

    def trial_of_recordings(self, recordings: dict[str, Recording]) -> Trial:
        """Return the trial that these recordings of every scenario make."""
        return self._trial("", recordings, self._judged(recordings), self.checks)

    def run(self, submission: Submission, scenario: Scenario, process: Worker) -> Recording:
        """Return the recording of one scenario. Raises `HostFault` if the machine or the grader is at fault."""
        # Programs take turns on the cores; each stays on the core where it starts.
        return self.runs.run(submission, scenario, next(self._turn), process)

    def _nothing(self, problem: str) -> Trial:
        recordings = not_run(self.grading.references, Ending("did-not-start", problem))
        return self._trial(problem, {}, self._judged(recordings), self.checks)

    def _judged(self, recordings: dict[str, Recording]) -> dict[str, Verdict]:
        return self.judge(recordings, self.grading.references)

    def _judged_where_different(self, recordings: dict[str, Recording]) -> dict[str, Verdict]:
        """Return the verdicts of the checks whose scenarios were run.

        If nothing differs from the solution, every check passes, as it does for the solution.
        """
        references = self.grading.references
        if not any(_differs(recording, references[name]) for name, recording in recordings.items()):
            return {c.name: Verdict(c.name, c.title, "passed", c.points, c.hint) for c in self.checks}
        return self._judged(not_run(references, Ending("did-not-start", "not run")) | recordings)

    def _needed(
        self, names: set[str], verdicts: dict[str, Verdict], recordings: dict[str, Recording]
    ) -> list[Scenario]:
        """Return the scenarios that unblocked checks need."""
        done = set(recordings)
        known = [check.name for check in self.checks if set(check.scenarios) <= done]
        passed = {name for name in known if not verdicts[name].blocks}
        asked = {
            scenario
            for check in self.checks
            if check.name in names and set(check.depends) <= passed
            for scenario in check.scenarios
        }
        return [scenario for scenario in self._shorter_first() if scenario.name in asked - done]

    def _trial(
        self,
        message: str,
        recordings: dict[str, Recording],
        verdicts: dict[str, Verdict],
        decided: tuple[ListedCheck, ...],
    ) -> Trial:
        statuses: dict[str, Status] = {}
        for check in self.checks:
            # A check whose scenarios were not run is blocked, or was not requested.
            if check in decided:
                statuses[check.name] = verdicts[check.name].status
            elif any(name in statuses and verdicts[name].blocks for name in check.depends):
                statuses[check.name] = "blocked"
        text = {name: verdicts[name] for name, status in statuses.items() if status in ("failed", "error")}
        findings = {name: verdict.finding or Finding(verdict.error) for name, verdict in text.items()}
        references = self.grading.references
        return Trial(
            message=message,
            statuses=statuses,
            findings=findings,
            run_in=tuple(recordings),
            messages=sum(len(recording.received) for recording in recordings.values()),
            earned={name: verdicts[name].earned for name, status in statuses.items() if status != "blocked"},
            differences=tuple(d for name, r in recordings.items() for d in differences(r, references[name])),
            seconds={name: recording.seconds for name, recording in recordings.items()},
        )
