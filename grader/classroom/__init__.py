"""A class of students and what grading them came to."""

from grader.grading.entry import Adjustment, Entry, Skipped, Student

__all__ = ["Adjustment", "Entry", "Skipped", "Student"]
