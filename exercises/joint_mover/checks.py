"""x."""
from grader.checking import Run, check
@check(points=100, hint="x")
def test_x(up: Run, down: Run, there: Run, limits: Run, out_of_reach: Run, not_a_number: Run, canceled: Run, after_cancel: Run, replaced: Run, replaced_upwards: Run, rejected_meanwhile: Run) -> None:
    """X."""
