"""Why a run can't go on."""

from __future__ import annotations

from grader.recording.recording import RunOutcome


class Stopped(Exception):
    """Raised inside the rig when the student's node can't be spun any further; `story` is for the student."""

    def __init__(self, outcome: RunOutcome, story: str) -> None:
        super().__init__(story)
        self.outcome = outcome
        self.story = story
