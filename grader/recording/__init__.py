"""What was seen while a node was spun: plain data, that nothing of the student's can change."""

from grader.recording.recording import Ending, EndPoint, Received, Recording, Sent

__all__ = ["EndPoint", "Ending", "Received", "Recording", "Sent"]
