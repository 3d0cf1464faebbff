"""What every student may read: the checks of `departure_board`. Each fixture is a scenario of scenarios.py."""

from __future__ import annotations

from grader.checking import Run, check


@check(
    points=4,
    hint="Publish the line in both callbacks.",
)
def test_shows_destination_and_delay(one_train: Run) -> None:
    """It shows a destination, and then the destination with the delay."""
    one_train.must_have_interface()
    one_train.must_match_series("data")


@check(
    points=4,
    hint="Both ends of a topic must be transient local. A publisher with a plain number is volatile.",
    depends=[test_shows_destination_and_delay],
    misconception="volatile where transient local is needed",
)
def test_a_late_passenger_sees_the_line(passenger: Run) -> None:
    """Late subscribers to /board get the current line."""
    passenger.must_match_series("data", subscriber="late")


@check(
    points=2,
    hint="Catch KeyboardInterrupt and ExternalShutdownException around rclpy.spin, then call rclpy.try_shutdown().",
    depends=[test_shows_destination_and_delay],
)
def test_ends_on_ctrl_c(one_train: Run) -> None:
    """On Ctrl-C it ends within 2 s, with no traceback."""
    one_train.must_end_on_ctrl_c()
