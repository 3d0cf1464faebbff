"""What every job of a grading needs: sent to the worker once, so that jobs refer to it instead of carrying it."""

from __future__ import annotations

import contextlib
import io
import json
import pickle
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from grader.exercise.exercise import Exercise


@dataclass(frozen=True)
class Sandbox:
    """What determines the mounts of a submission's sandbox: see `grader.sandbox.filesystem.mounts`."""

    readonly: tuple[Path, ...]
    hidden: tuple[Path, ...]
    file_bytes: int


class SharedObjects:
    """The owner's side: which objects the worker has, by their identity. The owner keeps them alive."""

    def __init__(self) -> None:
        self._objects: list[Any] = []
        self._numbers: dict[int, int] = {}

    @property
    def count(self) -> int:
        """The number of shared objects."""
        return len(self._objects)

    def add(self, objects: Iterable[Any]) -> bytes:
        """Add objects; return the bytes for `receive` in the worker."""
        new = [one for one in objects if id(one) not in self._numbers]
        first = len(self._objects)
        self._objects += new
        self._numbers |= {id(one): first + i for i, one in enumerate(new)}
        return pickle.dumps((first, new))

    def to_collect(self, exercise: Exercise, scenarios: Iterable[str], partly: bool) -> bytes | None:
        """Return what a process needs to collect the checks of an exercise; None if the exercise is not shared."""
        number = self._numbers.get(id(exercise))
        return None if number is None else json.dumps([number, partly, *scenarios]).encode()

    def pickled(self, job: Any, known: int) -> bytes:
        """Return `job`, pickled for a process that has the first `known` objects."""
        stream = io.BytesIO()
        _Pickler(stream, self._numbers, known).dump(job)
        return stream.getvalue()


class _Pickler(pickle.Pickler):
    def __init__(self, stream: io.BytesIO, numbers: dict[int, int], known: int) -> None:
        super().__init__(stream, pickle.HIGHEST_PROTOCOL)
        self._numbers, self._known = numbers, known

    def reducer_override(self, value: Any) -> Any:
        """See the documentation of pickle: not called for numbers, texts, lists and the like."""
        number = self._numbers.get(id(value))
        return NotImplemented if number is None or number >= self._known else (shared_object, (number,))


# --- in the worker, and in the processes that are forked from it

_objects: dict[int, Any] = {}


def shared_object(number: int) -> Any:
    """Return the object with this number."""
    return _objects[number]


def what_to_collect(content: bytes) -> tuple[Exercise, bool, list[str]]:
    """Return the exercise, whether it is judged partly, and the names of the scenarios, from `to_collect`."""
    number, partly, *scenarios = json.loads(content)
    return shared_object(number), partly, scenarios


def receive(content: bytes) -> None:
    """Take objects from the owner, and compute in advance what each job would compute."""
    first, objects = pickle.loads(content)
    for number, one in enumerate(objects, start=first):
        _objects[number] = one
        with contextlib.suppress(Exception):  # the job that needs it reports the fault
            _prepare(one)


def _prepare(one: Any) -> None:
    from grader.scenario.scenario import Scenario  # imported here, because the owner starts faster without it

    if isinstance(one, Scenario):
        from grader.runner.publishers import prepare_messages

        prepare_messages(one)
    elif isinstance(one, Sandbox):
        from grader.sandbox import filesystem

        filesystem.mounts(one.readonly, one.hidden, one.file_bytes)
