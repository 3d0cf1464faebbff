"""What every student may read: the checks of `bottle_line`. Each fixture is a scenario of scenarios.py."""

from __future__ import annotations

from grader.checking import Run, check


@check(
    points=4,
    hint="From 490 g to 510 g a bottle is full.",
)
def test_scale_says_which_bottles_are_full(line: Run) -> None:
    """The scale publishes whether each bottle is full."""
    line.must_have_interface()
    line.must_match_series("data", topic="/full")


@check(
    points=4,
    hint="One publish() for each message on /full.",
    depends=[test_scale_says_which_bottles_are_full],
)
def test_sorter_moves_the_gate(line: Run) -> None:
    """The sorter lets full bottles pass, and rejects the others."""
    line.must_match_series("data", topic="/gate", time=0.05)


@check(
    points=2,
    hint="Catch KeyboardInterrupt and ExternalShutdownException around rclpy.spin, then call rclpy.try_shutdown().",
    depends=[test_sorter_moves_the_gate],
)
def test_ends_on_ctrl_c(line: Run) -> None:
    """On Ctrl-C it ends within 2 s, with no traceback."""
    line.must_end_on_ctrl_c()
