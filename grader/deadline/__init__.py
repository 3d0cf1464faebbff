"""What late work costs, and what the instructor decided otherwise for a student."""

from grader.deadline.adjusting import Adjusting
from grader.deadline.deadline import Deadline, deadline_of
from grader.deadline.overrides import Override, OverridesError, overrides_in

__all__ = ["Adjusting", "Deadline", "Override", "OverridesError", "deadline_of", "overrides_in"]
