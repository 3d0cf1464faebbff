"""Known mistakes: what each of them fails, and which students' submissions fail the same."""

from grader.misconception.grouping import Group, Misconceptions, grouped
from grader.misconception.known import signatures
from grader.misconception.signature import Signature

__all__ = ["Group", "Misconceptions", "Signature", "grouped", "signatures"]
