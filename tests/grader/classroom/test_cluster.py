"""A class is graded by other processes over the network, as it is on this machine; one of them may die."""

from __future__ import annotations

import asyncio
import json
import os
import pickle
import re
import shutil
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Coroutine, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from importlib.util import find_spec
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import psutil
import pytest
from small_class import POINTS, ROOT, SmallClass, wait_until, without_timings

from grader.classroom import dask_worker
from grader.classroom.dask_worker import ExerciseFiles, differences, pack_exercise
from grader.classroom.request import ClusterLost, NoCluster
from grader.exercise import load
from grader.grading.grade import Options
from grader.sandbox.middleware import MiddlewareUnavailable
from grader.scenario.declared import declared
from grader.submission.submission import Submission
from interface_compiler import near, prefixes

# Importing it takes half a second, in each of pytest-xdist's processes.
pytestmark = pytest.mark.skipif(find_spec("distributed") is None, reason="Dask is not installed")


@contextmanager
def started(*arguments: str, cwd: Path, cache: Path) -> Iterator[subprocess.Popen[bytes]]:
    """Start a process of the cluster."""
    environment = {**os.environ, "SPINBOOK_CACHE": str(cache)}
    with (cwd / "cluster.log").open("ab") as log:
        process = subprocess.Popen(
            [sys.executable, "-m", "dask", *arguments], cwd=cwd, env=environment, stdout=log, stderr=log
        )
    try:
        yield process
    finally:
        process.terminate()
        try:
            process.wait(30)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def spinning(worker: subprocess.Popen[bytes]) -> bool:
    """Return whether a student's program runs under this worker of the cluster."""
    try:
        every = psutil.Process(worker.pid).children(recursive=True)
        return any("bwrap" in process.name() or len(process.children()) > 1 for process in every)
    except psutil.Error:
        return False


@pytest.mark.soak
def test_a_worker_and_then_the_scheduler_die_and_the_grades_are_those_of_one_machine(
    tmp_path: Path, cache: Path, graded: tuple[SmallClass, str]
) -> None:
    small = SmallClass(tmp_path / "course", cache)
    places = {"cwd": tmp_path, "cache": cache}
    with ExitStack() as cluster:
        local = ("--host", "127.0.0.1", "--no-dashboard")
        scheduler = cluster.enter_context(
            started("scheduler", "--port", "0", "--scheduler-file", "where.json", *local, **places)
        )
        where = tmp_path / "where.json"
        wait_until(lambda: where.exists() and where.stat().st_size)
        one = ("worker", "--scheduler-file", "where.json", "--nthreads", "1", "--no-nanny", *local)
        first, second = (cluster.enter_context(started(*one, **places)) for _ in range(2))
        address = json.loads(where.read_text(encoding="utf-8"))["address"]
        wait_until(lambda: (tmp_path / "cluster.log").read_text(errors="replace").count("Registered to") >= 2)
        process = small.start("--scheduler", address)
        wait_until(lambda: spinning(first) or process.poll() is not None)
        first.kill()
        printed, _ = process.communicate(timeout=240)
        assert process.returncode == 0, printed
        assert second.poll() is None
        assert small.finals() == POINTS
        assert without_timings(small.folder / "results") == without_timings(graded[0].folder / "results")

        process = small.start("--scheduler", address, out="again")
        small.wait_for_grades(1, process, out="again")
        scheduler.kill()
        printed, _ = process.communicate(timeout=240)
        assert process.returncode == 3, printed
        assert "The connection to the scheduler is lost." in printed
        assert "Run the same command to continue." in printed
        assert "Traceback" not in printed


class Answers:
    """What the scheduler of a cluster says of its workers, one answer after another, and whom it was to remove."""

    def __init__(self, answers: Iterable[dict[str, float]]) -> None:
        self._answers = iter(answers)
        self.removed: list[str] = []

    def sync(self, *asked: object, callback_timeout: float) -> dict[str, Any]:
        if (signs := next(self._answers, None)) is None:
            raise TimeoutError
        return {"workers": {worker: {"last_seen": seen} for worker, seen in signs.items()}}

    def run_on_scheduler(self, remove: Callable[..., Coroutine[Any, Any, None]]) -> None:
        with ThreadPoolExecutor(1) as pool:  # a browser of other tests has a running loop in this thread
            pool.submit(asyncio.run, remove(self)).result()

    async def remove_worker(self, address: str, stimulus_id: str) -> None:
        self.removed.append(address)


def test_a_worker_that_falls_silent_is_named_and_then_replaced_by_the_others() -> None:
    from grader.classroom.dask import SILENT_LOOKS, ClusterWatch

    said: list[str] = []
    cluster: Any = Answers({"busy": float(look), "stopped": 1.0} for look in range(SILENT_LOOKS + 1))
    watch = ClusterWatch(cluster, said.append)
    for _ in range(SILENT_LOOKS):
        watch.look(3)
    assert said[0] == "Waiting for 3 submissions on 2 workers."
    assert said[2] == "Waiting for 3 submissions on 2 workers. stopped has been silent for 20 s."
    assert not cluster.removed
    watch.look(1)
    assert cluster.removed == ["stopped"]
    assert said[-2:] == [
        "No sign of life for 60 s, so others take over: stopped.",
        "Waiting for 1 submission on 1 worker.",
    ]


def test_a_scheduler_that_stays_silent_is_given_up() -> None:
    from grader.classroom.dask import SILENT_LOOKS, ClusterWatch

    said: list[str] = []
    cluster: Any = Answers(())
    watch = ClusterWatch(cluster, said.append)
    for _ in range(SILENT_LOOKS - 1):
        watch.look(3)
    assert said == ["The scheduler does not answer. Waiting for it."] * (SILENT_LOOKS - 1)
    with pytest.raises(ClusterLost):
        watch.look(3)


def test_a_worker_differs_by_its_versions_or_its_sandbox() -> None:
    ours = {"python": "3.11.2", "sandbox": "namespaces"}
    assert not differences(ours, ours)
    assert differences(ours, {"python": "3.11.2", "sandbox": "landlock"}) == "sandbox landlock, here namespaces"


@pytest.mark.parametrize(
    ("why", "broken", "fault"),
    [
        ("The middleware is missing", "require_middleware", MiddlewareUnavailable("The middleware is missing.")),
        ("OSError: [Errno 28] No space left on device", "_prepare", OSError(28, "No space left on device")),
    ],
)
def test_a_worker_that_joined_later_and_can_not_grade_leaves_its_submissions_to_others(
    monkeypatch: pytest.MonkeyPatch, why: str, broken: str, fault: Exception
) -> None:
    def unavailable(*_: object) -> None:
        raise fault

    def leave(why: str) -> None:
        raise EOFError(why)

    monkeypatch.setattr(dask_worker, broken, unavailable)
    monkeypatch.setattr(dask_worker, "_leave", leave)
    with pytest.raises(EOFError, match=rf"^it can't grade: {re.escape(why)}$"):
        dask_worker.grade_on_worker(ExerciseFiles("", {}), Options(), {}, "", "anna", Submission("", "", "", "", None))


FREE = threading.Event()


def until_free() -> bool:
    """Keep a worker busy."""
    return FREE.wait(60)


def prepared() -> Any:
    """Return a grading as far as a cluster is compared with it."""
    return SimpleNamespace(runner=SimpleNamespace(options=Options(), isolation="landlock"))


def test_a_cluster_that_is_busy_with_another_class_keeps_its_workers(monkeypatch: pytest.MonkeyPatch) -> None:
    from distributed import Client, LocalCluster

    from grader.classroom import dask

    monkeypatch.setattr(dask, "LOOK_S", 0.1)
    said: list[str] = []
    with LocalCluster(n_workers=1, threads_per_worker=1, processes=False, dashboard_address=":0") as cluster:
        with Client(cluster, set_as_default=False) as other:
            busy = other.submit(until_free)
            wait_until(lambda: any(other.processing().values()))
            with dask.dask_backend(prepared(), cluster.scheduler_address, said.append):
                assert len(other.nthreads()) == 1
            FREE.set()
            assert busy.result()
        assert said == [f"Waiting for {cluster.workers[0].address} to describe itself."] * dask.SILENT_LOOKS


def test_the_scheduler_holds_an_exercise_once_for_a_class(monkeypatch: pytest.MonkeyPatch) -> None:
    from distributed import Client, LocalCluster

    from grader.classroom import dask

    size = 1_000_000
    sizes: list[int] = []
    monkeypatch.setattr(dask, "LOOK_S", 0.1)
    monkeypatch.setattr(dask, "grade_key", lambda _: "")
    monkeypatch.setattr(dask, "pack_exercise", lambda _: ExerciseFiles("", {"data": bytes(size)}))
    grading = prepared()
    grading.runner.exercise = None
    with LocalCluster(n_workers=0, processes=False, dashboard_address=":0") as cluster:

        def look(text: str) -> None:
            sizes.extend(len(pickle.dumps(task.run_spec)) for task in cluster.scheduler.tasks.values())
            raise ClusterLost(text)

        with Client(cluster, set_as_default=False) as client, pytest.raises(ClusterLost):
            next(dask.DaskBackend(grading, client, look).grade(dict.fromkeys("abcd", Submission("", "", "", "", None))))
    assert len(sizes) == 5
    assert size < sum(sizes) < 2 * size


def test_a_cluster_without_workers_is_waited_for_and_then_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    from distributed import LocalCluster

    from grader.classroom import dask

    monkeypatch.setattr(dask, "LOOK_S", 0.1)
    said: list[str] = []
    with (
        LocalCluster(n_workers=0, processes=False, dashboard_address=":0") as cluster,
        pytest.raises(NoCluster, match="it has no worker"),
        dask.dask_backend(prepared(), cluster.scheduler_address, said.append),
    ):
        raise AssertionError
    start = f"Waiting for a worker to join. To start one: dask worker {cluster.scheduler_address}"
    assert said == [start] * dask.SILENT_LOOKS


def test_a_class_that_is_stopped_while_it_waits_for_a_worker_needs_no_decision(small_class: SmallClass) -> None:
    from distributed import LocalCluster

    with LocalCluster(n_workers=0, processes=False, protocol="tcp", dashboard_address=":0") as cluster:
        others = set(cluster.scheduler.clients)
        process = small_class.start("--scheduler", cluster.scheduler_address)
        wait_until(lambda: cluster.scheduler.clients.keys() - others or process.poll() is not None)
        process.send_signal(signal.SIGINT)
        printed, _ = process.communicate(timeout=60)
    assert process.returncode == 130, printed
    assert printed.endswith("Stopped. This run has graded nothing yet.\n")


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (("tcp://127.0.0.1:9",), "no Dask scheduler answers there"),
        (("tls://127.0.0.1:9",), "perhaps check your TLS configuration"),
        (("tcp://127.0.0.1:9", "--jobs", "2"), "--nthreads says"),
    ],
)
def test_a_cluster_that_can_not_be_used_is_reported_in_a_sentence(
    small_class: SmallClass, arguments: tuple[str, ...], text: str
) -> None:
    code, printed = small_class.grade("--scheduler", *arguments)
    assert code == 2, printed
    assert text in printed
    assert "Traceback" not in printed


def test_a_course_grades_the_same_from_any_folder(tmp_path: Path) -> None:
    for name in ("here", "there"):
        shutil.copytree(ROOT / "exercises" / "go_to_goal", tmp_path / name / "exercises" / "go_to_goal")
    digests = [
        [scenario.digest for scenario in declared(load(tmp_path / name / "exercises" / "go_to_goal"), 1)]
        for name in ("here", "there")
    ]
    assert digests[0] == digests[1]


def test_the_interfaces_of_a_course_travel_to_the_workers_and_stay_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SPINBOOK_CACHE", str(tmp_path / "cache"))
    shutil.copytree(ROOT / "exercises" / "heartbeat", tmp_path / "course" / "exercises" / "heartbeat")
    (tmp_path / "course" / "course.toml").touch()
    exercise = load(tmp_path / "course" / "exercises" / "heartbeat")
    module = tmp_path / "course" / near.STORE / "0123" / prefixes.PYTHON / "arm_msgs" / "__init__.py"
    module.parent.mkdir(parents=True)
    module.write_text("# compiled")
    near.make_current(tmp_path / "course" / near.STORE, module.parents[4])

    packed = pack_exercise(exercise)
    for worker in ("first", "second"):
        folder = packed.unpack(tmp_path / worker)
        prefix = near.current(folder.parents[1] / near.STORE)
        assert prefix
        assert (prefix / prefixes.PYTHON / "arm_msgs" / "__init__.py").read_text() == "# compiled"
        shutil.rmtree(tmp_path / worker)
        assert prefix.is_dir()
