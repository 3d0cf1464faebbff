"""Runs each line of commands.txt with our `ros2`, and with the real one where it is installed, and shows what differs.

    .venv/bin/python benchmarks/ros2_commands/compare.py                    # ours: outputs go to build/ros2_commands/
    source /opt/ros/jazzy/setup.bash
    .venv/bin/python benchmarks/ros2_commands/compare.py --real /opt/ros/jazzy/bin/ros2 --only topic

A line is what comes after `ros2`; `5|` before it is its time limit (s), after which it gets Ctrl-C. Numbers that change
from run to run (times, rates, ids) are compared as `#`.
"""

from __future__ import annotations

import argparse
import contextlib
import difflib
import os
import re
import shlex
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

HERE = Path(__file__).parent
OURS = (sys.executable, "-m", "ros_in_python.ros2")
#: How long a line without a limit of its own may take (s).
LIMIT = 30.0
_CHANGING = re.compile(r"\d+\.\d+|\b[0-9a-f]{8,}\b|(?<=sec: )\d+|(?<=pid \[)\d+|(?<=_)\d{3,}")


def main() -> None:
    """Run all lines, and say how many are equal."""
    given = _arguments()
    signal.signal(signal.SIGINT, signal.default_int_handler)  # ignored in a shell's background, and by children then
    lines = [line for line in (HERE / "commands.txt").read_text().splitlines() if given.only in line.split()[0]]
    given.output.mkdir(parents=True, exist_ok=True)
    equal = 0
    with _zoo():
        for number, line in enumerate(lines, start=1):
            limit, command = _parts(line)
            ours = _answer((*OURS, *command), limit)
            (given.output / f"{number:03}.txt").write_text(f"$ ros2 {shlex.join(command)}\n{ours}")
            if not given.real:
                continue
            real = _answer((given.real, *command), limit)
            equal += ours == real
            if ours != real:
                print(
                    *difflib.unified_diff(real.splitlines(), ours.splitlines(), f"real: {line}", "ours", lineterm=""),
                    sep="\n",
                )
    print(f"{equal} of {len(lines)} equal" if given.real else f"{len(lines)} lines: {given.output}")


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--real", help="path of the real ros2")
    parser.add_argument("--only", default="", help="only lines of this noun")
    parser.add_argument("--output", type=Path, default=Path("build/ros2_commands"), help="where our outputs go")
    return parser.parse_args()


def _parts(line: str) -> tuple[float, list[str]]:
    limit, mark, rest = line.partition("|")
    return (float(limit), shlex.split(rest)) if mark and limit.isdigit() else (LIMIT, shlex.split(line))


def _answer(command: tuple[str, ...], limit: float) -> str:
    """Return what a command prints and its exit code, in an empty folder that has the list's parameter file."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "wild.yaml").write_text("/**:\n  ros__parameters:\n    gain: 3.5\n")
        running = subprocess.Popen(
            command, cwd=folder, env={**os.environ, "ROS_IN_PYTHON": "own"}, text=True, start_new_session=True,
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        )  # fmt: skip
        with contextlib.suppress(subprocess.TimeoutExpired):
            running.wait(limit)
        for number in (signal.SIGINT, signal.SIGKILL):
            with contextlib.suppress(subprocess.TimeoutExpired, ProcessLookupError):
                if running.poll() is None:
                    os.killpg(running.pid, number)
                text, _ = running.communicate(timeout=10)
                return f"{_CHANGING.sub('#', text)}exit code {running.returncode}\n"
    return "could not be ended\n"


@contextlib.contextmanager
def _zoo() -> Iterator[None]:
    running = subprocess.Popen([sys.executable, HERE / "zoo.py"], stdout=subprocess.PIPE, text=True)
    try:
        assert running.stdout
        assert running.stdout.readline() == "ready\n", "zoo.py did not start"
        yield
    finally:
        running.send_signal(signal.SIGINT)
        running.wait()


if __name__ == "__main__":
    main()
