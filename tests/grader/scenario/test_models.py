"""Ready-made worlds take whatever a student's node may send them."""

from __future__ import annotations

import math

import pytest
from geometry_msgs.msg import Twist

from grader.scenario import Turtle


@pytest.mark.parametrize("value", [math.inf, -math.inf, math.nan, 1e308])
def test_a_turtle_stays_computable_whatever_it_is_commanded(value: float) -> None:
    turtle = Turtle()
    command = Twist()
    command.linear.x = command.linear.y = command.angular.z = value
    for _ in range(2):
        turtle.hear("/turtle1/cmd_vel", command)
        turtle.step(0.02)
    assert turtle.state()["/turtle1/pose"].keys() >= {"x", "y", "theta"}
    assert math.isnan(turtle.theta) is not math.isfinite(value)
