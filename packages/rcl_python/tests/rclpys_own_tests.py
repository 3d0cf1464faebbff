"""Runs rclpy's own tests over rcl_python or a middleware, and prints how many pass.

    python rclpys_own_tests.py FOLDER [--over rcl_python|fastdds|lockstep] [--only NAME]

FOLDER is `rclpy/test` of https://github.com/ros2/rclpy at the release that is installed. Each file runs in its own
process. `fastdds` and `lockstep` are the compiled module over these middlewares: the first for comparison, the second
to show that rmw_lockstep is complete, without a hub. Failures are listed; expected_failures.toml says which are
expected over rcl_python, and why. A test that fails or passes there unexpectedly makes the exit code 1.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ET
from collections import Counter
from pathlib import Path

from rmw_lockstep.library import UnavailableLibrary, library

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

EXPECTED = Path(__file__).with_name("expected_failures.toml")
_RUN = """
import sys, types
# The package's own __init__ looks for a module that only rclpy's build makes.
sys.modules["test"] = types.ModuleType("test")
sys.modules["test"].__path__ = [{tests!r}]
{install}
import pytest
sys.exit(pytest.main(sys.argv[1:]))
"""
_INSTALL = "import rcl_python; rcl_python.install()"
KINDS = ("passed", "failed", "skipped")
#: A test that hangs is ended after this time (s), a file after ten times as much.
_LIMIT = 30


def outcomes(file: Path, over: str) -> dict[str, str]:
    """Run one file; return the name of each test -> passed, failed or skipped."""
    code = _RUN.format(tests=str(file.parent.resolve()), install=_INSTALL if over == "rcl_python" else "")
    with tempfile.TemporaryDirectory() as folder:
        report = Path(folder, "report.xml")
        options = ["-q", "-p", "no:cacheprovider", "-p", "pytest_timeout", f"--timeout={_LIMIT}"]
        options += [
            f"--junitxml={report}",
            "--rootdir",
            str(file.parent.parent),
            "-o",
            "junit_family=xunit2",
            str(file),
        ]
        environment = {**os.environ, **_middleware(over), "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1", "ROS_LOG_DIR": folder}
        command = [sys.executable, "-c", code, *options]
        try:
            subprocess.run(
                command, env=environment, cwd=file.parent.parent, capture_output=True, timeout=10 * _LIMIT, check=False
            )
            return _read(report)
        except (subprocess.TimeoutExpired, OSError, ET.ParseError):
            return {f"{file.stem}::(the file)": "failed"}


def _middleware(over: str) -> dict[str, str]:
    """Return the environment variables that make rclpy load this middleware."""
    if over != "lockstep":
        return {}
    found = library()
    if isinstance(found, UnavailableLibrary):
        sys.exit(f"{found.reason} {found.remedy}")
    return found.environment(os.environ)


def _read(report: Path) -> dict[str, str]:
    found = {}
    for case in ET.parse(report).iter("testcase"):
        name = f"{case.get('classname', '').rpartition('test.')[2]}::{case.get('name')}"
        kinds = {child.tag for child in case}
        found[name] = "failed" if kinds & {"failure", "error"} else "skipped" if "skipped" in kinds else "passed"
    return found


def main() -> int:
    """Run every file and print the figures."""
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=Path)
    parser.add_argument("--over", choices=("rcl_python", "fastdds", "lockstep"), default="rcl_python")
    parser.add_argument("--only", default="")
    given = parser.parse_args()
    expected = tomllib.loads(EXPECTED.read_text(encoding="utf-8"))["expected"] if given.over == "rcl_python" else {}
    total: Counter[str] = Counter()
    surprises = []
    for file in sorted(given.folder.glob("test_*.py")):
        if given.only not in file.name:
            continue
        found = outcomes(file, given.over)
        counts = Counter(found.values())
        total += counts
        print(
            f"{file.name:45} {counts['passed']:4} passed {counts['failed']:3} failed {counts['skipped']:3} skipped",
            flush=True,
        )
        for name, outcome in found.items():
            if outcome == "failed":
                print(f"    {name}  {expected.get(name, '(unexpected)')}", flush=True)
            if (outcome == "failed") != (name in expected) and given.over == "rcl_python":
                surprises.append(f"{name}: {outcome}")
    judged = total["passed"] + total["failed"]
    print(f"{total['passed']} of {judged} passed ({total['passed'] / max(judged, 1):.1%}), {total['skipped']} skipped")
    print("\n".join(["", "Against expected_failures.toml:", *surprises]) if surprises else "")
    return 1 if surprises else 0


if __name__ == "__main__":
    sys.exit(main())
