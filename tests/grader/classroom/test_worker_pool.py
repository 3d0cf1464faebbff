"""The worker processes may die; the work is done all the same."""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import tempfile
from pathlib import Path

import psutil
import pytest
from process_tree import new_worker, runs, workers_of
from small_class import ROOT, wait_until

from grader.exercise import load
from grader.grading.grading import grade_submission
from grader.submission.reader import of_source
from grader.workers import HostFault, WorkerPool
from grader.workers.jobs import ListJob
from grader.workers.shared import SharedObjects, receive

EXERCISE = ROOT / "exercises" / "joint_velocity"


class _Surroundings:
    """A job that brings its own code: the worker can't import this module."""

    def __reduce__(self) -> tuple[object, ...]:
        asked = "__import__('time').tzname[0], __import__('os').environ['RMW_IMPLEMENTATION']"
        return eval, (f"type('Surroundings', (), {{'run': lambda *_: ({asked})}})()",)


def test_jobs_are_done_until_the_pool_is_closed_whatever_process_of_it_dies(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In the time zone of the command, with the middleware that is here, and also where its folder was removed."""
    exercise = load(EXERCISE)
    monkeypatch.setenv("TZ", "Asia/Tokyo")
    monkeypatch.setenv("RMW_IMPLEMENTATION", "of_another_installation")
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    (tmp_path / "here").rmdir()
    job = ListJob(exercise)
    others = workers_of(psutil.Process())
    with WorkerPool() as workers:
        assert workers.do(_Surroundings()) == ("JST", "")  # type: ignore[arg-type]
        with workers.reserve() as worker:
            before = worker.do(job)
            process = new_worker(others)
            [first] = workers_of(process)
            assert worker.do(job) == before
            assert workers_of(process) == [first], "jobs are done in one process"
            first.kill()
            wait_until(lambda: not runs(first))
            assert worker.do(job) == before
            [second] = [other for other in workers_of(process) if other != first]
        wait_until(lambda: not runs(second))
        workers.share([exercise])
        assert workers.do(job) == before
        [fork_server] = [child for child in process.children() if child.name() == "fork server"]
        fork_server.kill()
        wait_until(lambda: not runs(fork_server))
        assert workers.do(job) == before, "the new worker has what jobs share"
        assert not runs(process), "a worker whose fork server is gone can run no program"
        new_worker(others).kill()
        assert workers.do(job) == before
    with pytest.raises(HostFault, match="the worker process is gone"):
        workers.do(job)


def test_a_job_refers_to_what_its_process_has_and_carries_the_rest() -> None:
    exercise = load(EXERCISE)
    job, shared = ListJob(exercise), SharedObjects()
    receive(shared.add([exercise]))
    carried, referred = shared.pickled(job, known=0), shared.pickled(job, known=shared.count)
    assert len(referred) < len(carried) / 4
    assert pickle.loads(carried) == pickle.loads(referred) == job


def test_a_process_of_the_pool_that_takes_too_much_memory_gets_an_error_and_spares_the_machine() -> None:
    code = "from grader.workers.fork import limit_memory\nlimit_memory()\nlen(bytes(500 << 20))\nbytes(2 << 30)"
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert ended.stderr.strip().endswith("MemoryError")
    assert "line 4" in ended.stderr


def test_a_pool_leaves_nothing_among_temporary_files_even_if_its_process_was_killed(
    temporary_files: Path,
) -> None:
    code = "import sys, tempfile\nfrom pathlib import Path\nfrom grader.workers import WorkerPool\n"
    code += "with WorkerPool(Path(tempfile.mkdtemp())):\n    print('ready', flush=True)\n    sys.stdin.read()"
    command = [sys.executable, "-c", code]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as process:
        assert process.stdout
        assert process.stdout.readline() == b"ready\n"
        assert len(list(temporary_files.iterdir())) == 2
        process.kill()
    wait_until(lambda: not list(temporary_files.iterdir()))


def test_a_submission_is_graded_where_the_path_for_temporary_files_is_too_long_for_a_socket(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    long = tmp_path / ("long" * 25)
    long.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", None)
    monkeypatch.setenv("TMPDIR", os.fspath(long))
    exercise = load(EXERCISE).public()
    solution = (ROOT / "solutions" / "joint_velocity" / "solution.py").read_bytes()

    grade = grade_submission(exercise, of_source("solution", solution, exercise))

    assert grade.score == grade.points > 0


def test_a_command_that_leaves_the_cpus_to_its_workers_has_one_thread_with_numpy() -> None:
    code = "from grader.workers.pool import leave_cpus_to_workers; leave_cpus_to_workers(); import numpy, os"
    code += "; numpy.zeros(1); print(len(os.listdir('/proc/self/task')))"
    unset = {name: value for name, value in os.environ.items() if name != "OPENBLAS_NUM_THREADS"}
    assert subprocess.run([sys.executable, "-c", code], env=unset, capture_output=True, check=True).stdout == b"1\n"
