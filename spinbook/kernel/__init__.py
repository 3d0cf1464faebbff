"""What runs inside a notebook: nodes as processes, `ros2` commands, plots, the turtle's picture."""
