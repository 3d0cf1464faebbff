"""`python -m grader`."""

from grader.command import grade

grade(prog_name="python -m grader")
