"""`ros2` and `python -m spinbook.ros2`: the same as `spinbook ros2`, ready sooner."""

from __future__ import annotations

import sys


def main() -> None:
    """Run the command as this process; a signal during the imports ends it as quietly as one later on."""
    try:
        from spinbook.ros2.command import ros2

        ros2(prog_name="ros2")
    except KeyboardInterrupt:
        sys.exit(2)


if __name__ == "__main__":
    main()
