"""What the grader saw while a node ran, as plain data that no student's program can change."""

from grader.recording.events import (
    Call,
    Cancel,
    Event,
    Feedback,
    Goal,
    GoalState,
    ParameterChange,
    ParameterReading,
    ProgramExit,
)
from grader.recording.recording import Ending, Endpoint, ReceivedMessage, Recording, SentMessage

__all__ = [
    "Call",
    "Cancel",
    "Ending",
    "Endpoint",
    "Event",
    "Feedback",
    "Goal",
    "GoalState",
    "ParameterChange",
    "ParameterReading",
    "ProgramExit",
    "ReceivedMessage",
    "Recording",
    "SentMessage",
]
