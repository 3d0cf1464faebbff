"""What functions of a launch file use beside actions: `launch.logging.get_logger`, `perform_substitutions`."""

from __future__ import annotations

import logging
import sys

from ros_in_python.launch.substitutions import Context, Text, text_of


def get_logger(name: str = "launch") -> logging.Logger:
    """Return a logger whose lines look as those of the launch itself."""
    logger = logging.getLogger(f"launch file.{name}")
    if not logger.handlers:
        handler = logging.StreamHandler(sys.stdout)
        handler.setFormatter(logging.Formatter(f"[%(levelname)s] [{name}]: %(message)s"))
        logger.addHandler(handler)
        logger.setLevel(logging.INFO)
        logger.propagate = False
    return logger


def perform_substitutions(context: Context, substitutions: Text) -> str:
    """Return the text of substitutions in a row."""
    return text_of(substitutions, context)
