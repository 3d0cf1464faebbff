"""A class at a glance: the instructor's page."""

from grader.overview.page import overview_page

__all__ = ["overview_page"]
