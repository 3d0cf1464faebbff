"""What was seen while a node was run: plain data, that nothing of the student's can change."""

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
