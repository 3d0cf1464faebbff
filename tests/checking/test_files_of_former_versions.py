"""What an earlier version wrote is still read: grades in a class's results, and the recordings next to them."""

from __future__ import annotations

import json
from dataclasses import replace

import plain_grades as plain
from made_up import EMPTY

from grader.recording import Ending, Recording
from grader.recording.recording import from_json as recordings_from_json
from grader.recording.recording import to_json as recordings_to_json
from grader.report.as_json import from_json, to_json


def as_formerly_written(recording: Recording) -> str:
    [entries] = json.loads(recordings_to_json({"plain": recording})).values()
    entries["hold"] = {"idle": "quiet"}.get(entries["synchronization"], entries["synchronization"])
    entries["ending"]["story"] = entries["ending"].pop("message")
    del entries["synchronization"]
    return json.dumps({"plain": entries})


def test_a_grade_of_a_former_version_is_read() -> None:
    entries = json.loads(to_json(plain.entry(plain.HALF), "key"))
    entries["grade"]["hold"] = "lockstep"
    del entries["grade"]["synchronization"]

    entry, key = from_json(json.dumps(entries))

    assert entry.grade == replace(plain.HALF, synchronization="lockstep")
    assert key == "key"


def test_recordings_of_a_former_version_are_read() -> None:
    over_fastdds = replace(EMPTY, synchronization="idle", ending=Ending("crashed", "Your program ended."))

    assert recordings_from_json(as_formerly_written(over_fastdds)) == {"plain": over_fastdds}
