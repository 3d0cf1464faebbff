"""Scenarios: what a student's node is spun against, declared in a few lines."""

from grader.scenario.scenario import Message, Scenario

__all__ = ["Message", "Scenario"]
