"""What one student is told: a page, and the plot on it."""

from grader.feedback.page import feedback_page
from grader.feedback.plot import feedback_plot

__all__ = ["feedback_page", "feedback_plot"]
