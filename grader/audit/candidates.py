"""The programs that an audit tries: the author's files, and some without work in them; the score that each must get."""

from __future__ import annotations

import ast
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

from grader.audit.baselines import programs
from grader.audit.check_list import problem_of
from grader.audit.result import AuditProblem, JudgedProgram, Trial
from grader.audit.store import Store
from grader.audit.trial import Trials
from grader.checking.verdict import ListedCheck
from grader.exercise.exercise import Exercise
from grader.exercise.imported_files import tree_of
from grader.exercise.mistakes import Mistake, mistakes_of
from grader.exercise.starter import starter
from grader.grading.reference import solution_file
from grader.recording.recording import Recording
from grader.scenario.declared import declared
from grader.scenario.scenario import Scenario
from grader.submission.reader import of_mistake, of_source
from grader.submission.submission import Submission

#: A node that exists and does nothing.
IDLE = """import rclpy

rclpy.init()
rclpy.spin(rclpy.create_node({name!r}))
"""


@dataclass(frozen=True)
class Candidate:
    """One program, with its kind and its file.

    For a mistake, `caught_by` names the checks that must catch it, and `line` is where its file names them.
    """

    kind: Literal["solution", "right", "mistake", "nothing", "baseline"]
    name: str
    file: Path
    title: str
    submission: Submission
    caught_by: tuple[str, ...] = ()
    line: int = 1


def right_solutions(exercise: Exercise) -> list[Candidate]:
    """Return the solution, then the other right solutions."""
    solution = solution_file(exercise)
    files = [solution, *sorted((solution.parent / "right").glob("*.py"))]
    return [_candidate("solution" if file == solution else "right", file, exercise) for file in files]


def mistakes(exercise: Exercise) -> list[Candidate]:
    """Return every usual mistake."""
    return [_of_mistake(mistake, exercise) for mistake in mistakes_of(exercise)]


def _of_mistake(mistake: Mistake, exercise: Exercise) -> Candidate:
    submission = of_mistake(mistake, exercise)
    name, title, file = f"mistakes/{mistake.name}", mistake.summary, mistake.file
    return Candidate("mistake", name, file, title, submission, mistake.caught_by, mistake.line)


def baselines(exercise: Exercise, reference: Recording) -> list[Candidate]:
    """Return the programs without work in them, which may get few points. `reference` is as in `programs`."""
    return [
        Candidate("baseline", name, solution_file(exercise), name, of_source(name, source.encode(), exercise))
        for name, source in programs(exercise, reference).items()
    ]


def nothings(exercise: Exercise) -> list[Candidate]:
    """Return the programs that must get no points: the starter, an empty file, and a node that does nothing."""
    solution = solution_file(exercise)
    sources = {
        "the starter": starter(solution.read_text(encoding="utf-8")),
        "an empty file": "",
        "a node that does nothing": IDLE.format(name=exercise.node_name),
    }
    return [
        Candidate("nothing", name, solution, name, of_source(name, source.encode(), exercise))
        for name, source in sources.items()
    ]


def _candidate(kind: Literal["solution", "right"], file: Path, exercise: Exercise) -> Candidate:
    code = file.read_bytes()
    name = file.name if kind == "solution" else f"{file.parent.name}/{file.name}"
    docstring = ast.get_docstring(tree_of(code.decode("utf-8", errors="replace"))) or file.stem
    title = docstring.partition("\n")[0]
    return Candidate(kind, name, file, title, of_source(str(file), code, exercise))


@dataclass(frozen=True)
class Seed:
    """One seed, with the scenarios that differ from those of the audit's own seed."""

    number: int
    scenarios: tuple[Scenario, ...]
    randomised: tuple[Scenario, ...]


def seeds_of(trials: Trials, count: int) -> list[Seed]:
    """Return the seeds that make `count` together with the audit's own; none if no scenario has random values."""
    runner = trials.grading.runner
    usual = {scenario.digest for scenario in runner.scenarios}
    seeds = []
    for number in range(1, count + 1):
        if number != runner.options.seed:
            scenarios = declared(runner.exercise, number)
            changed = tuple(scenario for scenario in scenarios if scenario.digest not in usual)
            if changed:
                seeds.append(Seed(number, scenarios, changed))
    return seeds


def over_seed(trials: Trials, store: Store, seed: Seed, candidates: list[Candidate]) -> dict[str, Trial]:
    """Try each candidate (the solution is the first) with this seed. Return the trials by name."""
    made: dict[str, Recording] = {}

    def references() -> dict[str, Recording]:
        if not made:
            solution = candidates[0].submission
            made.update(trials.grading.references)
            made.update(_recordings(trials, solution, seed.randomised))
        return made

    def trial_of(candidate: Candidate) -> Trial:
        grading = trials.grading
        options = replace(grading.runner.options, seed=seed.number)
        runner = replace(grading.runner, scenarios=seed.scenarios, options=options)
        with_seed = replace(trials, grading=replace(grading, runner=runner, references=references()))
        if candidate is candidates[0]:
            return with_seed.trial_of_recordings(references())
        recordings = _recordings(trials, candidate.submission, seed.randomised)
        return with_seed.trial_of_recordings({**references(), **recordings})

    digests = [scenario.digest for scenario in seed.randomised]
    return {
        candidate.name: store.trial(
            {"code": candidate.submission.digest, "seed": seed.number, "randomised": digests},
            lambda candidate=candidate: trial_of(candidate),  # type: ignore[misc]
        )
        for candidate in candidates
    }


def _recordings(trials: Trials, submission: Submission, scenarios: tuple[Scenario, ...]) -> dict[str, Recording]:
    """Return the recordings by scenario.

    A scenario with the same messages and steps as another is not run again, because only the numbers matter here.
    """
    done: list[Scenario] = []
    made: dict[str, Recording] = {}
    with trials.runs.process() as process:
        for scenario in scenarios:
            like = next((other for other in done if _content(other) == _content(scenario)), None)
            if like:
                made[scenario.name] = replace(made[like.name], scenario=scenario.name)
            else:
                made[scenario.name] = trials.run(submission, scenario, process)
                done.append(scenario)
    return made


def _content(scenario: Scenario) -> Scenario:
    """Return the part of a scenario that its random numbers can change."""
    return replace(scenario, name="", title="", computer_time="apart")


def judged(candidate: Candidate, trial: Trial) -> JudgedProgram:
    """Return the result of a program."""
    return JudgedProgram(candidate.name, candidate.kind, candidate.title, trial.failed, trial.score)


def problems_of(
    candidates: list[Candidate], trials: dict[str, Trial], checks: tuple[ListedCheck, ...], seed: int | None = None
) -> list[AuditProblem]:
    """Return the results that are not as they must be; `seed` is set if it is not the default one."""
    problems: list[AuditProblem] = []
    for candidate in candidates:
        trial = trials[candidate.name]
        if candidate.kind == "nothing":
            problems += _nothing(candidate, trial, checks)
        elif candidate.kind == "mistake":
            problems += _mistake(candidate, trial, checks)
        elif candidate.kind != "baseline":
            problems += _right(candidate, trial, seed)
    return problems


def _right(candidate: Candidate, trial: Trial, seed: int | None) -> list[AuditProblem]:
    with_seed = f" with --seed {seed}" if seed is not None else ""
    fix = "If the solution is right, fix the check. Otherwise fix the solution."
    return [
        AuditProblem(
            candidate.file,
            None,
            f"the right solution {candidate.name} fails {name}{with_seed}: {trial.findings[name].text}",
            fix,
            about=name,
        )
        for name in trial.failed
    ]


def _nothing(candidate: Candidate, trial: Trial, checks: tuple[ListedCheck, ...]) -> list[AuditProblem]:
    fix = "Let it depend on the check that requires any message at all."
    return [
        problem_of(
            check, f"{candidate.name} passes {check.name} and gets {check.points:g} points, but must get none", fix
        )
        for check in checks
        if trial.statuses.get(check.name) == "passed" and check.points
    ]


def _mistake(candidate: Candidate, trial: Trial, checks: tuple[ListedCheck, ...]) -> list[AuditProblem]:
    subject = f"the mistake {candidate.name} (“{candidate.title}”)"
    known = {check.name for check in checks}

    def problem(about: str, text: str, fix: str) -> AuditProblem:
        return AuditProblem(candidate.file, candidate.line, text, fix, about=about)

    if not candidate.caught_by:
        fix = "Write “Caught by:” and the names of the checks in its section, or in its docstring."
        return [problem(candidate.name, f"{subject} names no check that must catch it", fix)]
    problems = []
    for name in candidate.caught_by:
        status = trial.statuses.get(name)
        fix = "Fix the check so that it fails, or take it off the list under “Caught by:”."
        if name not in known:
            fix = "Write the check (again), or take it off the list under “Caught by:”."
            problems.append(problem(name, f"{subject} is to be caught by {name}: there is no such check", fix))
        elif status == "passed":
            problems.append(problem(name, f"{name} lets {subject} through", fix))
        elif status == "blocked":
            by = ", ".join(trial.failed) or "another check"
            text = f"{name} is to catch {subject}, but is blocked: it depends on {by}, which fails"
            problems.append(problem(name, text, fix))
    for name in trial.failed:
        if name not in candidate.caught_by:
            text = f"{subject} fails {name}, too, which it does not name: {trial.findings[name].text}"
            fix = "If the check should pass here, fix it. Otherwise add it under “Caught by:”."
            problems.append(problem(name, text, fix))
    return problems
