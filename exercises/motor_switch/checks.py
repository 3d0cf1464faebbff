"""x."""
from grader.checking import Run, check
@check(points=100, hint="x")
def test_x(switching: Run, already: Run, off_first: Run, emergency: Run, released: Run, pressed_while_off: Run, pressed_twice: Run, many: Run) -> None:
    """X."""
