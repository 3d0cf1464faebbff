"""Spinbook turns Markdown chapters about ROS 2 into notebooks whose cells are nodes that really run."""

__version__ = "0.1.0"
