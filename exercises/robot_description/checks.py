"""x."""
from grader.checking import Run, check
@check(points=50, hint="x")
def test_x(late: Run, started: Run, changed: Run, same: Run, refused: Run, after_refusal: Run) -> None:
    """X."""
