"""A class of students and the results of grading them."""

from grader.grading.entry import Adjustment, Entry, Skipped, Student

__all__ = ["Adjustment", "Entry", "Skipped", "Student"]
