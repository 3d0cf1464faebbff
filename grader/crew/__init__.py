"""Trusted processes that do the work of grading: each spin and each judging in a fresh process of its own."""

from grader.crew.crew import Crew, HostFault

__all__ = ["Crew", "HostFault"]
