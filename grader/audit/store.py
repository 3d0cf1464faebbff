"""Keeps trials: a program that has been judged is not judged again while nothing that it depends on has changed."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import threading
from collections.abc import Callable
from typing import Any

from grader.audit.recordings import audit_folder, engine, keep
from grader.audit.trial import Difference, Trial, Trials
from grader.checking.verdict import Finding
from grader.grading.reference import digest_of, solution_file

#: What decides a trial beside what decides a recording.
JUDGING = ("checking", "audit/trial.py", "audit/listing.py")


class Store:
    """The kept trials of one exercise. `made` and `kept` count those made now and known from before."""

    def __init__(self, trials: Trials) -> None:
        runner = trials.grading.runner
        exercise = runner.exercise
        self._folder = audit_folder(exercise.name)
        self._common = {
            "solution": digest_of([solution_file(exercise)]),
            "exercise": digest_of([exercise.folder / "exercise.toml", *exercise.check_files]),
            "scenarios": [scenario.digest for scenario in runner.scenarios],
            "engine": engine(runner.middleware, JUDGING),
            "isolation": str(runner.isolation),
        }
        self._lock = threading.Lock()
        self.made = 0
        self.kept = 0

    def trial(self, key: dict[str, Any], make: Callable[[], Trial]) -> Trial:
        """The trial that `key` names, kept or made now."""
        text = json.dumps({**self._common, **key}, sort_keys=True)
        file = self._folder / f"{hashlib.sha256(text.encode()).hexdigest()[:32]}.json"
        try:
            trial = _from_json(file.read_text(encoding="utf-8"))
            file.touch()
            known = True
        except (OSError, ValueError, KeyError, TypeError):
            trial = make()
            keep(file, json.dumps(dataclasses.asdict(trial)).encode())
            known = False
        with self._lock:
            self.kept += known
            self.made += not known
        return trial


def _from_json(text: str) -> Trial:
    entries = json.loads(text)
    return Trial(
        **{
            **entries,
            "findings": {name: Finding(**finding) for name, finding in entries["findings"].items()},
            "spun": tuple(entries["spun"]),
            "differences": tuple(Difference(**difference) for difference in entries["differences"]),
        }
    )
