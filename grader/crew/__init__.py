"""Trusted processes that do the work of grading: the spins of a submission in one or a few, its judging in another."""

from grader.crew.crew import Crew
from grader.crew.hand import Hand, HostFault

__all__ = ["Crew", "Hand", "HostFault"]
