"""Keeps trials: a program that has been judged once is not spun again while nothing that it depends on has changed."""

from __future__ import annotations

import contextlib
import dataclasses
import hashlib
import json
import os
import tempfile
import time
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from grader.audit.comparing import Difference
from grader.audit.trial import Trial, Trials
from grader.checking.wrong import Finding
from grader.grading.reference import cache_folder, solution_file
from grader.grading.versions import GRADER, digest_of, versions

#: The parts of the grader that decide what comes of a trial. Reports do not.
DECIDING = ("grading/spinning.py", "audit/trial.py", "audit/comparing.py", "audit/listing.py", "loopback.xml")
DECIDING_FOLDERS = ("checking", "crew", "exercise", "recording", "rig", "sandbox", "scenario", "submission")

#: What nobody has asked for since is thrown away.
KEPT_DAYS = 30


class Store:
    """The kept trials of one exercise."""

    def __init__(self, trials: Trials) -> None:
        spinner = trials.grading.spinner
        exercise = spinner.exercise
        self._folder = cache_folder().parent / "audit" / exercise.name
        self._common = {
            "solution": digest_of([solution_file(exercise)]),
            "exercise": digest_of([exercise.folder / "exercise.toml", *exercise.check_files]),
            "scenarios": [scenario.digest for scenario in spinner.scenarios],
            "engine": engine(),
            "isolation": str(spinner.isolation),
        }
        self.spun = 0
        self.kept = 0

    def trial(self, key: dict[str, Any], make: Callable[[], Trial]) -> Trial:
        """The trial that `key` names, from the store or made now."""
        text = json.dumps({**self._common, **key}, sort_keys=True)
        file = self._folder / f"{hashlib.sha256(text.encode()).hexdigest()[:32]}.json"
        try:
            trial = _from_json(file.read_text(encoding="utf-8"))
            file.touch()
        except (OSError, ValueError, KeyError, TypeError):
            trial = make()
            self.spun += 1
            with contextlib.suppress(OSError):  # where nothing can be kept, it is made anew each time
                self._keep(file, trial)
        else:
            self.kept += 1
        return trial

    def _keep(self, file: Path, trial: Trial) -> None:
        file.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile("w", encoding="utf-8", dir=file.parent, delete=False) as temporary:
            temporary.write(json.dumps(dataclasses.asdict(trial)))
        Path(temporary.name).replace(file)

    def tidy(self) -> None:
        """Throw away what has not been asked for in a long time."""
        oldest = time.time() - KEPT_DAYS * 24 * 3600
        with contextlib.suppress(OSError):
            for entry in os.scandir(self._folder):
                if entry.stat().st_mtime < oldest:
                    Path(entry.path).unlink(missing_ok=True)


@cache
def engine() -> str:
    """A digest of everything of ours that decides what comes of a trial, and of Python's and ROS's versions."""
    files = [GRADER / name for name in DECIDING]
    files += [file for folder in DECIDING_FOLDERS for file in sorted((GRADER / folder).rglob("*.py"))]
    others = {name: version for name, version in versions().items() if name != "grader"}
    return f"{digest_of(files)} {json.dumps(others, sort_keys=True)}"


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
