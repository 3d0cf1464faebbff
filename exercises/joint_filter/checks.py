"""x."""
from grader.checking import Run, check
@check(points=100, hint="x")
def test_x(default: Run, started: Run, all_of_it: Run, changed: Run, refused: Run, other_types: Run, after_refusal: Run, reordered: Run, missing_joint: Run, new_joint: Run) -> None:
    """X."""
