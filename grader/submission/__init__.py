"""What a student hands in: a file, a notebook's cell or an installed executable."""

from grader.submission.reader import NoSubmission, Submission, read

__all__ = ["NoSubmission", "Submission", "read"]
