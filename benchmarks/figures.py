"""Writes docs/figures.md: what Spinbook costs on this machine, by the other benchmarks.

    python benchmarks/figures.py [--out docs/figures.md] [--only TITLE]

It takes about half an hour. Seconds are worth something only on an idle machine, so the file tells what else ran.
"""

from __future__ import annotations

import argparse
import os
import platform
import subprocess
import sys
from datetime import date
from importlib import metadata
from pathlib import Path

import psutil

ROOT = Path(__file__).parents[1]

#: The commands that measure, by title. Each prints a Markdown table or plain lines.
MEASURES = {
    "One grade": ["benchmarks/grader/grade.py", "--runs", "5"],
    "Classes": ["benchmarks/class/sizes.py", "10", "200"],
    "Beside nbgrader and otter-grader": ["benchmarks/class/against_others.py"],
    "Equal recordings beside busy loops": ["benchmarks/determinism/determinism.py", "--rounds", "2"],
    "Building chapters": ["benchmarks/build/chapters.py"],
}

#: Of one CPU, in percent: what other programs may take before a machine no longer counts as idle.
IDLE_PERCENT = 10.0


def main() -> int:
    """Run each benchmark, and write what they print; return 1 if one of them failed."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out", type=Path, default=ROOT / "docs" / "figures.md", help="the file  (default: %(default)s)"
    )
    parser.add_argument("--only", action="append", choices=MEASURES, help="may be given several times")
    options = parser.parse_args()
    parts = ["# Figures", f"Made by `make figures`; each release replaces them.\n\n{_machine()}"]
    failed = 0
    for title in options.only or MEASURES:
        print(f"{title} ...", file=sys.stderr)
        others = _others()
        done = subprocess.run(
            [sys.executable, *MEASURES[title]], cwd=ROOT, stdout=subprocess.PIPE, text=True, check=False
        )
        failed += bool(done.returncode)
        command = f"`python {' '.join(MEASURES[title])}` ended with {done.returncode}. {others}"
        parts += [f"## {title}", command, _shown(done.stdout)]
    options.out.write_text("\n\n".join(parts) + "\n", encoding="utf-8")
    return 1 if failed else 0


def _machine() -> str:
    """Return what the figures are of: computer, Python and versions, and the size of the environment."""
    lines = Path("/proc/cpuinfo").read_text().splitlines()
    model = next((line for line in lines if line.startswith("model name")), f": {platform.machine()}")
    commit = subprocess.run(["git", "describe", "--always", "--dirty"], cwd=ROOT, capture_output=True, text=True)
    size = sum(file.lstat().st_blocks * 512 for file in Path(sys.prefix).rglob("*"))
    rows = {
        "date, version": f"{date.today()}, {commit.stdout.strip()}",
        "computer": f"{len(os.sched_getaffinity(0))} × {model.partition(': ')[2]}, Linux {platform.release()}",
        "Python, rclpy": f"{platform.python_version()}, {metadata.version('ros-jazzy-rclpy')}",
        "environment": f"{size / 1e6:.0f} MB",
    }
    return "| | |\n| --- | --- |\n" + "\n".join(f"| {name} | {value} |" for name, value in rows.items())


def _others() -> str:
    """Return a sentence about what other programs took of the CPUs in one second."""
    percent = psutil.cpu_percent(1.0) * (psutil.cpu_count() or 1)
    idle = "idle" if percent < IDLE_PERCENT else "**not idle: don't quote the seconds**"
    return f"Before it, other programs took {percent:.0f} % of a CPU: {idle}."


def _shown(text: str) -> str:
    """Return tables as they are, and anything else as a block."""
    return text.strip() if text.lstrip().startswith("|") else f"```\n{text.rstrip()}\n```"


if __name__ == "__main__":
    sys.exit(main())
