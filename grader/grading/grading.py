"""From a submission to its grade."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

from grader.checking.ending_message import lacks_a_notebooks_module, message_of
from grader.checking.verdict import Verdict
from grader.exercise.exercise import Exercise
from grader.grading.grade import Grade, Options, Outcome
from grader.grading.public import PublicPart, public_part
from grader.grading.reference import reference, solution_file, versions
from grader.grading.scenario_runner import ScenarioRunner
from grader.recording.printed_paths import without_paths
from grader.recording.recording import Ending, Recording, not_run
from grader.runner.tracebacks import in_cells
from grader.sandbox.isolation import choose
from grader.sandbox.program import Isolation, SandboxUnavailable
from grader.scenario.declared import declared
from grader.scenario.scenario import Scenario
from grader.submission.submission import Submission
from grader.workers.pool import HostFault, WorkerPool


@dataclass(frozen=True)
class Grading:
    """Everything needed to grade submissions of one exercise. Create it once, and grade any number of them."""

    runner: ScenarioRunner
    references: dict[str, Recording]
    public: PublicPart | None = None
    """Set if only the public checks judge."""

    def grade(self, submission: Submission) -> Grade:
        """Return the grade of one submission. A fault of the machine or the grader becomes a `host-error`, never a
        score.
        """
        if submission.question:
            return self._grade(submission, {}, (), "undecided", submission.question, time.monotonic())
        return self._graded(submission, partial(self._recordings, submission))

    def judge(self, submission: Submission, recordings: dict[str, Recording]) -> Grade:
        """Return the grade of a submission from its recordings, by scenario, without running anything."""
        return self._graded(submission, lambda: recordings)

    def _graded(self, submission: Submission, record: Callable[[], dict[str, Recording]]) -> Grade:
        began = time.monotonic()
        try:
            recordings = record()
            verdicts = self.runner.judge(recordings, self.references)
        except HostFault as fault:
            text = str(fault).strip().splitlines()[-1]
            return self._grade(submission, {}, (), "host-error", f"This is not your fault: {text}", began)
        endings = [recording.ending for recording in recordings.values()]
        missing = (lacks_a_notebooks_module(ending, submission.sources) for ending in endings)
        # A student's own check says how to install it.
        if not self.public and (module := next(filter(None, missing), None)):
            text = f"This is not your fault: {module}, which notebooks may have, is missing here. "
            text += "Instructors: pip install 'spinbook[notebooks,plots]', or name it in exercise.toml (packages)."
            # Without the recordings: once it is installed, they must not be judged again.
            return self._grade(submission, {}, (), "host-error", text, began)
        broken = [verdict for verdict in verdicts if verdict.status == "error"]
        if broken:
            text = f"This is not your fault: the check {broken[0].name} broke: {broken[0].error}"
            return self._grade(submission, recordings, verdicts, "host-error", text, began)
        first = recordings[self.runner.scenarios[0].name].ending
        outcome: Outcome = "graded" if first.outcome == "completed" else first.outcome
        return self._grade(submission, recordings, verdicts, outcome, message_of(first, self.runner.exercise), began)

    def _recordings(self, submission: Submission) -> dict[str, Recording]:
        if submission.program:
            return self.runner.run(submission)
        names = (scenario.name for scenario in self.runner.scenarios)
        return not_run(names, Ending("did-not-start", submission.problem))

    def _grade(
        self,
        submission: Submission,
        recordings: dict[str, Recording],
        verdicts: tuple[Verdict, ...],
        outcome: Outcome,
        message: str,
        began: float,
    ) -> Grade:
        recordings = {name: replace(each, log=without_paths(each.log)) for name, each in recordings.items()}
        first = recordings.get(self.runner.scenarios[0].name)
        none = outcome in ("host-error", "undecided")
        score = 0.0 if none else sum(verdict.earned for verdict in verdicts)
        points = sum(verdict.points for verdict in verdicts) or self.runner.exercise.points
        # The version of Python matters only if something is wrong.
        newer = "" if outcome == "graded" and score == points else submission.newer_python
        return Grade(
            exercise=self.runner.exercise.name,
            submission=submission.name,
            digest=submission.digest,
            outcome=outcome,
            message=" ".join(filter(None, (submission.warning, message, *submission.notes, newer))),
            score=score,
            points=points,
            verdicts=verdicts,
            isolation=str(self.runner.isolation),
            seed=self.runner.options.seed,
            versions=versions(),
            self_check=self.public is not None,
            hidden_checks=self.public.hidden_checks if self.public else 0,
            hidden_points=self.public.hidden_points if self.public else 0.0,
            line=first.ending.line if first else None,
            log=in_cells(first.log, submission.sources) if first else "",
            seconds=time.monotonic() - began,
            recordings=recordings,
            references=self.references,
        )


def grading_of(exercise: Exercise, options: Options, workers: WorkerPool) -> Grading:
    """Prepare to grade submissions of `exercise`.

    Raises `ExerciseError` when its author has something to fix, `SandboxUnavailable` when students' code can't be
    isolated here, and `HostFault` when the solution can't be run through a fault of the machine or ours.

    In a student's copy, or with `exercise.public()`, only the public checks judge: a self-check. The code that runs is
    then the user's own, so it may also run without isolation; the grade's `isolation` says so.
    """
    used = [*(topic.type for topic in exercise.topics), *(endpoint.type for endpoint in exercise.endpoints)]
    workers.prepare_types(type_name.rpartition("/")[0].replace("/", ".") for type_name in used)
    if exercise.public_only or (exercise.solution_folder is None and exercise.public_file.exists()):
        isolation = _isolation_of_ones_own(options)
        public = public_part(exercise.public(), options, isolation, workers)
        runner = ScenarioRunner(exercise.public(), public.scenarios, isolation, options, workers)
        runner.share(public.references.values())
        return Grading(runner, public.references, public)
    solution_file(exercise)
    scenarios: tuple[Scenario, ...] = declared(exercise, options.seed)
    runner = ScenarioRunner(exercise, scenarios, choose(options.isolation), options, workers)
    references = reference(runner)
    runner.share(references.values())
    return Grading(runner, references)


def _isolation_of_ones_own(options: Options) -> Isolation:
    try:
        return choose(options.isolation)
    except SandboxUnavailable:
        if options.isolation is not None:
            raise
        return choose(Isolation.NONE)


def grade_submission(exercise: Exercise, submission: Submission, options: Options | None = None) -> Grade:
    """Return the grade of one submission. Raises what `grading_of` raises."""
    options = options or Options()
    with WorkerPool() as workers:
        return grading_of(exercise, options, workers).grade(submission)
