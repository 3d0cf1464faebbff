"""Grading on Gradescope: the results that it shows, and the autograder to upload there."""
