"""`ros2`, and `python -m ros_in_python.ros2`, which is the same."""

from __future__ import annotations

import sys


def main() -> None:
    """Run the command as this process; a signal during the imports ends it as quietly as one later on."""
    try:
        from ros_in_python.ros2.command import ros2

        ros2(prog_name="ros2")
    except KeyboardInterrupt:
        sys.exit(2)


if __name__ == "__main__":
    main()
