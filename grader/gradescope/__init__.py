"""Grading on Gradescope: what it is told of a grade, and the autograder that is uploaded there."""
