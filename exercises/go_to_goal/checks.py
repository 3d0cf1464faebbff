"""x."""
from grader.checking import Run, check
@check(points=100, hint="x")
def test_x(ahead: Run, no_goal: Run, short_way: Run, behind: Run, next_goal: Run, new_goal: Run) -> None:
    """X."""
