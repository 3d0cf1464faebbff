"""x."""
from grader.checking import Run, check
@check(points=50, hint="x")
def test_x(start: Run, minute: Run) -> None:
    """X."""
