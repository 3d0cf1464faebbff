"""Grades one submission: spins it through every scenario and judges what it published."""

from grader.grading.grade import Grade
from grader.grading.grading import grade_submission, grading_of
from grader.grading.options import Options

__all__ = ["Grade", "Options", "grade_submission", "grading_of"]
