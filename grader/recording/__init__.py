"""What the grader saw while a node ran: plain data, which no student's program can change."""

from grader.recording.events import (
    Call,
    Cancel,
    Event,
    Exit,
    Feedback,
    Goal,
    GoalState,
    ParameterChange,
    ParameterReading,
)
from grader.recording.recording import Ending, EndPoint, Received, Recording, Sent

__all__ = [
    "Call",
    "Cancel",
    "EndPoint",
    "Ending",
    "Event",
    "Exit",
    "Feedback",
    "Goal",
    "GoalState",
    "ParameterChange",
    "ParameterReading",
    "Received",
    "Recording",
    "Sent",
]
