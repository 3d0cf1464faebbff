"""Spins a Node class that comes without a main of its own: `python -m spinbook.runtime.spin_class FILE CLASS`."""

from __future__ import annotations

import runpy
import sys
from pathlib import Path

import rclpy
from rclpy.executors import ExternalShutdownException


def main() -> None:
    """Make the node and spin it until Ctrl-C."""
    file, class_name = Path(sys.argv[1]), sys.argv[2]
    sys.argv = [str(file)]
    module = runpy.run_path(str(file), run_name=file.stem)
    rclpy.init()
    node = module[class_name]()
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
