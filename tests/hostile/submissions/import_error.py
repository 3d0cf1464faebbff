"""Imports a name that its module does not have."""

from rclpy.node import Knot

Knot()
