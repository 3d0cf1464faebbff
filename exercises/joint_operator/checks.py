"""x."""
from grader.checking import Run, check
@check(points=100, hint="x")
def test_x(succeeds: Run, several: Run, rejects: Run, aborts: Run, answers_late: Run, appears: Run, never_ends: Run, slow: Run, late_and_slow: Run, refuses_to_cancel: Run, ignores_the_cancel: Run, aborts_late: Run) -> None:
    """X."""
