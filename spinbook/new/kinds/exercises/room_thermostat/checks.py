"""What every student may read: the checks of `room_thermostat`. Each fixture is a scenario of scenarios.py."""

from __future__ import annotations

from grader.checking import Run, check


@check(
    points=2,
    hint="Declare both parameters in __init__, and publish in the callback.",
)
def test_publishes_the_heater(defaults: Run) -> None:
    """It publishes one message on /heater for each temperature."""
    defaults.must_have_interface()
    defaults.must_answer()


@check(
    points=4,
    hint="Between the two the heater stays as it was: remember it.",
    depends=[test_publishes_the_heater],
)
def test_switches_the_heater(defaults: Run) -> None:
    """The heater goes on below the target by more than the margin, and off at the target."""
    defaults.must_match("data")


@check(
    points=3,
    hint="Declare the parameters with doubles, such as 20.0, and read them with get_parameter().",
    depends=[test_switches_the_heater],
    misconception="an integer for a double",
)
def test_parameters_at_the_start(started: Run) -> None:
    """It uses the parameters that it is started with."""
    started.must_match("data")


@check(
    points=3,
    hint="Read the parameters for each temperature. An on-set callback still gets the old values from get_parameter().",
    depends=[test_switches_the_heater],
    misconception="reads parameters once",
)
def test_parameters_set_while_it_runs(changed: Run) -> None:
    """It accepts values that are set while it runs, and uses them from the next temperature on."""
    changed.must_take("target", 22.0)
    changed.must_take("margin", 3.0)
    changed.must_match("data")


@check(
    points=1,
    hint="Catch KeyboardInterrupt and ExternalShutdownException around rclpy.spin, then call rclpy.try_shutdown().",
    depends=[test_publishes_the_heater],
)
def test_ends_on_ctrl_c(defaults: Run) -> None:
    """On Ctrl-C it ends within 2 s, with no traceback."""
    defaults.must_end_on_ctrl_c()
