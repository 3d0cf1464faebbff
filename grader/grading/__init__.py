"""Grades one submission: runs it through every scenario and judges what it published."""

from grader.grading.grade import Grade, Options
from grader.grading.grading import grade_submission, grading_of

__all__ = ["Grade", "Options", "grade_submission", "grading_of"]
