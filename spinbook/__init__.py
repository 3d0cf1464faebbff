"""Spinbook turns Markdown chapters about ROS 2 into notebooks whose cells are nodes that really run."""

from __future__ import annotations

__version__ = "0.1.0"


def load_ipython_extension(shell: object) -> None:
    """Called by `%load_ext spinbook`."""
    from spinbook.kernel.extension import load

    load(shell)
