"""A class's grades as files for spreadsheets, learning platforms and CI."""

from grader.gradebook.files import write_gradebook

__all__ = ["write_gradebook"]
