"""`python -m ros_in_python.turtlesim OUT.svg`: draw the running turtlesim."""

from ros_in_python.turtlesim.command import turtle

turtle(prog_name="python -m ros_in_python.turtlesim")
