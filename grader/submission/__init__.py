"""What a student hands in: a file, a notebook's cell or an installed executable."""

from grader.submission.reader import NoSubmission, read
from grader.submission.submission import Submission

__all__ = ["NoSubmission", "Submission", "read"]
