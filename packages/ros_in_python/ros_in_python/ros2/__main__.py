"""`ros2`, and `python -m ros_in_python.ros2`, which is the same."""

from __future__ import annotations

import io
import sys


def main() -> None:
    """Run the command as this process; a signal during the imports ends it as quietly as one later on."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a message may have characters that the terminal's encoding lacks
    try:
        from ros_in_python.ros2.command import ros2

        ros2(prog_name="ros2")
    except KeyboardInterrupt:
        sys.exit(2)


if __name__ == "__main__":
    main()
