"""Sends submissions to a Dask cluster, where other machines grade them.

Each worker has the same version of this software and of ROS 2, and gets the exercise with the first task. What
`dask.distributed` does with tasks of a worker that has died is in https://distributed.dask.org/en/stable/resilience.html.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from grader.grading.grading import Grading
from grader.grading.versions import versions
from grader.marking.elsewhere import about, mark
from grader.marking.fault import fault
from grader.marking.key import key_of
from grader.marking.marks import Marked, NoCluster
from grader.marking.parcel import pack
from grader.submission import Submission

if TYPE_CHECKING:
    from distributed import Client

#: How long a scheduler has to answer, and then how long there may be no worker, in seconds.
SCHEDULER_S, WORKER_S = 10.0, 60.0


@dataclass(frozen=True)
class Cluster:
    """The workers of one scheduler. Each takes as many submissions at once as it has threads."""

    grading: Grading
    client: Client

    @property
    def key(self) -> str:
        """See `Markers`."""
        return key_of(self.grading)

    def mark(self, submissions: Mapping[str, Submission]) -> Iterator[Marked]:
        """See `Markers`. A worker that dies costs another try; after four deaths it is a fault of ours."""
        from distributed import as_completed

        if not submissions:
            return
        spinner = self.grading.spinner
        parcel = pack(spinner.exercise)
        asked = {
            self.client.submit(mark, parcel, spinner.options, self.key, who, submission, pure=False): who
            for who, submission in submissions.items()
        }
        try:
            for future in as_completed(list(asked), loop=self.client.loop):
                who = asked[future]
                error = future.exception()
                if error is None:
                    yield future.result()
                else:
                    told = f"the cluster could not grade it: {type(error).__name__}: {error}"
                    grade = fault(spinner, submissions[who], told)
                    yield Marked(who, grade, None)
        finally:
            self.client.cancel(list(asked))


@contextlib.contextmanager
def cluster(grading: Grading, address: str) -> Iterator[Cluster]:
    """The cluster whose scheduler is at `address`, such as tcp://10.0.0.5:8786, with a worker at least.

    Raises `NoCluster` where there is none, or where a worker's versions are not this machine's.
    """
    try:
        from distributed import Client
    except ImportError:
        raise NoCluster("Dask is not installed here: pip install 'spinbook[cluster]'") from None
    try:
        client = Client(address, timeout=SCHEDULER_S, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        told = str(error).splitlines()[0] if str(error) else type(error).__name__
        raise NoCluster(f"--scheduler {address}: nobody answers there as a Dask scheduler does: {told}") from None
    with client:
        try:
            client.wait_for_workers(1, timeout=WORKER_S)
        except TimeoutError:
            raise NoCluster(f"--scheduler {address}: it has no worker. Start some: dask worker {address}") from None
        middleware = grading.spinner.middleware
        _same_versions(versions(middleware), client.run(about, middleware, on_error="return"))
        yield Cluster(grading, client)


def _same_versions(ours: Mapping[str, str], told: Mapping[str, object]) -> None:
    for worker, theirs in sorted(told.items()):
        if not isinstance(theirs, dict):
            raise NoCluster(f"The worker {worker} can't grade: {type(theirs).__name__}: {theirs}")
        if differs := [
            f"{name} {theirs.get(name)}, here {ours[name]}" for name in ours if theirs.get(name) != ours[name]
        ]:
            raise NoCluster(f"The worker {worker} would grade otherwise: {'; '.join(differs)}. Install the same there.")
