"""`ros2`, and `python -m ros_in_python.ros2`, which is the same."""

from __future__ import annotations

import io
import signal
import sys


def main() -> None:
    """Run the command as this process; a signal during the imports ends it as quietly as one later on.

    Nothing else may be imported before another installation's modules are out of the way.
    """
    signal.signal(signal.SIGINT, signal.default_int_handler)  # it may have been ignored: see cli.py
    try:
        from groundwork.clean_environment import restart_if_polluted

        restart_if_polluted("ros_in_python.ros2.__main__")
        for stream in (sys.stdout, sys.stderr):
            if isinstance(stream, io.TextIOWrapper):
                stream.reconfigure(errors="replace")  # a message may have what the terminal's encoding lacks
        # Message classes need a single function of that package; its generator and parser take a sixth of the start.
        sys.modules["rosidl_generator_py.generate_py_impl"] = None  # type: ignore[assignment]
        from ros_in_python.ros2.command import ros2

        ros2(prog_name="ros2")
    except KeyboardInterrupt:
        sys.exit(2)


if __name__ == "__main__":
    main()
