"""Why a run can't go on."""

from __future__ import annotations

from grader.recording.recording import RunOutcome


class Stopped(Exception):
    """Raised inside a runner when the student's program can't be run any further; `story` is for the student."""

    def __init__(self, outcome: RunOutcome, story: str) -> None:
        super().__init__(story)
        self.outcome = outcome
        self.story = story
