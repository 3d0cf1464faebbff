"""From a submission to its grade."""

from __future__ import annotations

import time
from dataclasses import dataclass

from grader.checking.verdict import Verdict
from grader.crew import Crew, HostFault
from grader.crew.jobs import JudgeJob
from grader.exercise import Exercise
from grader.grading.grade import Grade, Outcome
from grader.grading.message import message_of
from grader.grading.options import Options
from grader.grading.public import PublicPart, public_part
from grader.grading.reference import reference, solution_file
from grader.grading.spinning import Spinner
from grader.grading.versions import versions
from grader.recording import Ending, Recording
from grader.sandbox import Isolation, SandboxUnavailable, choose
from grader.scenario import Scenario
from grader.scenario.declared import declared
from grader.submission import Submission


@dataclass(frozen=True)
class Grading:
    """Everything that grading one exercise's submissions needs, proved: make it once and grade as many as you like."""

    spinner: Spinner
    references: dict[str, Recording]
    public: PublicPart | None = None
    """Set where only the public checks judge."""

    def grade(self, submission: Submission) -> Grade:
        """The grade of one submission; a fault of the machine's or ours becomes a `host-error`, never a score."""
        began = time.monotonic()
        try:
            recordings = self._recordings(submission)
        except HostFault as fault:
            told = str(fault).strip().splitlines()[-1]
            return self._grade(submission, {}, (), "host-error", f"This is not your fault: {told}", began)
        return self._judged(submission, recordings, began)

    def judge(self, submission: Submission, recordings: dict[str, Recording]) -> Grade:
        """The grade of a submission of which these are the recordings, by scenario; nothing is run."""
        return self._judged(submission, recordings, time.monotonic())

    def _judged(self, submission: Submission, recordings: dict[str, Recording], began: float) -> Grade:
        titles = {scenario.name: scenario.title for scenario in self.spinner.scenarios}
        job = JudgeJob(self.spinner.exercise, recordings, self.references, titles)
        try:
            verdicts: tuple[Verdict, ...] = self.spinner.crew.do(job)
        except HostFault as fault:
            told = str(fault).strip().splitlines()[-1]
            return self._grade(submission, {}, (), "host-error", f"This is not your fault: {told}", began)
        broken = [verdict for verdict in verdicts if verdict.status == "error"]
        if broken:
            told = f"This is not your fault: the check {broken[0].name} broke: {broken[0].error}"
            return self._grade(submission, recordings, verdicts, "host-error", told, began)
        first = recordings[self.spinner.scenarios[0].name].ending
        outcome: Outcome = "graded" if first.outcome == "completed" else first.outcome
        return self._grade(submission, recordings, verdicts, outcome, message_of(first), began)

    def _recordings(self, submission: Submission) -> dict[str, Recording]:
        if submission.program:
            return self.spinner.spin(submission)
        ending = Ending("did-not-start", submission.problem)
        return {
            scenario.name: Recording(scenario.name, (), (), (), (), "none", False, ending)
            for scenario in self.spinner.scenarios
        }

    def _grade(
        self,
        submission: Submission,
        recordings: dict[str, Recording],
        verdicts: tuple[Verdict, ...],
        outcome: Outcome,
        message: str,
        began: float,
    ) -> Grade:
        first = recordings.get(self.spinner.scenarios[0].name)
        host = outcome == "host-error"
        return Grade(
            exercise=self.spinner.exercise.name,
            submission=submission.name,
            digest=submission.digest,
            outcome=outcome,
            message=" ".join(filter(None, (submission.warning, message))),
            score=0.0 if host else sum(verdict.earned for verdict in verdicts),
            points=sum(verdict.points for verdict in verdicts) or self.spinner.exercise.points,
            verdicts=verdicts,
            isolation=str(self.spinner.isolation),
            seed=self.spinner.options.seed,
            versions=versions(self.spinner.middleware),
            self_check=self.public is not None,
            hidden_checks=self.public.hidden_checks if self.public else 0,
            hidden_points=self.public.hidden_points if self.public else 0.0,
            hold=first.hold if first else "none",
            line=first.ending.line if first else None,
            log=first.log if first else "",
            seconds=time.monotonic() - began,
            recordings=recordings,
            references=self.references,
        )


def grading_of(exercise: Exercise, options: Options, crew: Crew) -> Grading:
    """Make ready to grade submissions of `exercise`.

    Raises `ExerciseError` when its author has something to mend, `SandboxUnavailable` when students' code can't be
    kept apart here, and `HostFault` when the solution can't be spun by a fault of the machine's or ours.

    In a student's copy, or with `exercise.public()`, only the public checks judge: a self-check. The code that runs is
    one's own then, so that it may run where nothing can be kept apart, too; the grade's `isolation` says so.
    """
    if exercise.public_only or (exercise.solution_folder is None and exercise.public_file.exists()):
        isolation = _isolation_of_ones_own(options)
        public = public_part(exercise.public(), options, isolation, crew)
        spinner = Spinner(exercise.public(), public.scenarios, isolation, options, crew)
        return Grading(spinner, public.references, public)
    solution_file(exercise)
    scenarios: tuple[Scenario, ...] = declared(exercise, options.seed)
    spinner = Spinner(exercise, scenarios, choose(options.isolation), options, crew)
    return Grading(spinner, reference(spinner))


def _isolation_of_ones_own(options: Options) -> Isolation:
    try:
        return choose(options.isolation)
    except SandboxUnavailable:
        if options.isolation is not None:
            raise
        return Isolation.NONE


def grade_submission(exercise: Exercise, submission: Submission, options: Options | None = None) -> Grade:
    """The grade of one submission. Raises what `grading_of` raises."""
    options = options or Options()
    with Crew(options.middleware) as crew:
        return grading_of(exercise, options, crew).grade(submission)
