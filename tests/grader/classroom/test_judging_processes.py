"""The processes that judge: what they share, and what they do not."""

from __future__ import annotations

import getpass
import re
import shutil
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import psutil
import pytest
from process_tree import new_worker, runs, workers_of
from small_class import ROOT, wait_until

from grader.checking.verdict import Verdict
from grader.exercise import Exercise, ExerciseError, load
from grader.recording.recording import Ending, Recording
from grader.workers import WorkerPool
from grader.workers.jobs import JudgeJob

BEGINNING = "from grader.checking import Run, check\nFILE = {file!r}\n"

CHECK = '''
with open(FILE, "a") as stream:
    print("imported", file=stream)
SEEN = []

@check(points=1, hint="None.")
def test_once(first: Run) -> None:
    """It is new."""
    SEEN.append(first)
    assert len(SEEN) == 1, "something is left of another judging"
    assert first.recording.log == "right", f"it is {first.recording.log}"
'''

WRITES_A_FILE = '''
@check(points=1, hint="None.")
def test_writing(first: Run, tmp_path) -> None:
    """It writes a file."""
    (tmp_path / "file").write_text("text")
    raise AssertionError(tmp_path)
'''


@pytest.fixture
def exercise(tmp_path: Path) -> Exercise:
    """An exercise whose only check passes with the log `right`; it writes down when it is imported."""
    folder = tmp_path / "exercises" / "small"
    shutil.copytree(ROOT / "exercises" / "joint_velocity", folder)
    (folder / "hidden_checks.py").unlink()
    write(folder, CHECK)
    return load(folder)


def write(folder: Path, checks: str) -> None:
    (folder / "checks.py").write_text(BEGINNING.format(file=str(folder / "imports.txt")) + checks)


def recording(log: str, scenario: str = "first") -> dict[str, Recording]:
    return {scenario: Recording(scenario, (), (), (), (), True, Ending("completed", ""), log=log)}


def job_of(exercise: Exercise, log: str = "right") -> JudgeJob:
    return JudgeJob(exercise, recording(log), recording("right"), {})


def imports(exercise: Exercise) -> int:
    return len((exercise.folder / "imports.txt").read_text().splitlines())


def judged(workers: WorkerPool, job: JudgeJob) -> Verdict:
    [verdict] = workers.judge(job)
    return verdict


def test_checks_are_imported_once_and_each_judging_finds_them_new(exercise: Exercise, workers: WorkerPool) -> None:
    workers.share([exercise])
    first = [judged(workers, job_of(exercise)) for _ in range(3)]
    assert [verdict.status for verdict in first] == ["passed"] * 3
    assert imports(exercise) == 1


def test_judgings_at_the_same_time_do_not_mix(exercise: Exercise, workers: WorkerPool) -> None:
    logs = [f"log {i}" for i in range(12)]
    workers.share([exercise])
    with ThreadPoolExecutor(4) as pool:
        verdicts = list(pool.map(lambda log: judged(workers, job_of(exercise, log)), logs))
    assert [verdict.finding and verdict.finding.text.splitlines()[0] for verdict in verdicts] == [
        f"it is {log}" for log in logs
    ]


def test_an_exercise_that_is_not_shared_is_judged_as_well(exercise: Exercise, workers: WorkerPool) -> None:
    verdicts = [judged(workers, job_of(exercise)) for _ in range(2)]
    assert [verdict.status for verdict in verdicts] == ["passed"] * 2


def test_recordings_that_are_shared_later_are_judged(exercise: Exercise, workers: WorkerPool) -> None:
    workers.share([exercise])
    judged(workers, job_of(exercise))
    job = job_of(exercise, "shared later")
    workers.share([*job.recordings.values(), *job.references.values()])
    verdict = judged(workers, job)
    assert verdict.finding is not None
    assert "shared later" in verdict.finding.text


@pytest.mark.parametrize("checks", ["import no_such_module\n", "", "def test_plain(first): pass\n"])
def test_checks_that_cannot_be_used_are_the_authors_fault_in_each_judging(
    exercise: Exercise, workers: WorkerPool, checks: str
) -> None:
    write(exercise.folder, checks)
    workers.share([exercise])
    for _ in range(2):
        with pytest.raises(ExerciseError, match=r"checks\.py"):
            workers.judge(job_of(exercise))


def test_a_scenario_that_did_not_exist_before_is_found(exercise: Exercise, workers: WorkerPool) -> None:
    workers.share([exercise])
    judged(workers, job_of(exercise))
    job = job_of(exercise)
    more = recording("right", "second")
    both = JudgeJob(exercise, job.recordings | more, job.references | more, {})
    assert judged(workers, both).status == "passed"


def test_a_process_that_has_died_is_replaced_and_all_end_with_the_pool(exercise: Exercise) -> None:
    others = workers_of(psutil.Process())
    with WorkerPool() as workers:
        workers.share([exercise])
        judged(workers, job_of(exercise))
        worker = new_worker(others)
        [collected] = workers_of(worker)
        collected.kill()
        wait_until(lambda: not runs(collected))
        assert judged(workers, job_of(exercise)).status == "passed"
        left = [one for one in workers_of(worker) if one != collected]
        assert left
    assert not any(runs(one) for one in left)
    assert imports(exercise) == 2


def test_checks_may_use_what_pytest_offers(exercise: Exercise, workers: WorkerPool) -> None:
    text = '''
import logging, warnings
import pytest

@pytest.fixture
def twice(first: Run) -> str:
    return 2 * first.recording.log

@check(points=1, hint="None.")
@pytest.mark.parametrize("times", [1])
def test_fixtures(twice, times, tmp_path, monkeypatch, capfd, caplog) -> None:
    """It works."""
    (tmp_path / "file").write_text(twice)
    monkeypatch.setenv("SOMETHING", "1")
    print("printed")
    logging.warning("logged")
    warnings.warn("warned")
    assert capfd.readouterr().out == "printed\\n"
    assert caplog.messages == ["logged"]
'''
    write(exercise.folder, text)
    workers.share([exercise])
    verdicts = [judged(workers, job_of(exercise)) for _ in range(2)]
    assert [verdict.status for verdict in verdicts] == ["passed"] * 2


def test_what_checks_write_is_gone_when_they_end_and_pytests_folders_of_others_stay(
    exercise: Exercise, temporary_files: Path
) -> None:
    write(exercise.folder, WRITES_A_FILE)
    # pytest keeps the last three in its own folder, and removes the others there.
    others = [temporary_files / f"pytest-of-{getpass.getuser()}" / f"pytest-{number}" for number in range(5)]
    for other in others:
        other.mkdir(parents=True)
    with WorkerPool() as workers:
        verdicts = [judged(workers, job_of(exercise)) for _ in range(2)]
        wait_until(lambda: not list(temporary_files.glob("spinbook-*/*")))
    texts = [verdict.finding.text for verdict in verdicts if verdict.finding]
    assert len(set(texts)) == 2, "both wrote into the same folder"
    assert all(re.match(rf"{re.escape(str(temporary_files))}/spinbook-\w+/spinbook-checks-", text) for text in texts)
    assert list(temporary_files.glob("spinbook-*")) == []
    assert sorted(others[0].parent.iterdir()) == others
