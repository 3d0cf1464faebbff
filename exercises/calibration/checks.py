"""x."""
from grader.checking import Run, check
@check(points=100, hint="x")
def test_x(one: Run, slow: Run, several: Run, again: Run, failing: Run, not_finite: Run, appears: Run, never: Run, too_late: Run, absent: Run) -> None:
    """X."""
