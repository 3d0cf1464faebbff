"""Which middleware (RMW) the nodes use, and whether it loads."""

from __future__ import annotations

import os
import subprocess
import sys

from spinbook.doctor.finding import Finding, missing, ok, warning
from spinbook.runtime.environment import missing_middleware

#: What rclpy exits with where RMW_IMPLEMENTATION can't be loaded.
NOT_LOADED = 102
_NAME_IT = "from rclpy.utilities import get_rmw_implementation_identifier as name; print(name())"


def examine(name: str) -> Finding:
    """Load the middleware in a process of its own: it ends the process where it is absent."""
    wanted = os.environ.get("RMW_IMPLEMENTATION", "")
    absent = missing_middleware(os.environ)
    trial = subprocess.run([sys.executable, "-c", _NAME_IT], capture_output=True, text=True, check=False)
    if trial.returncode == 0:
        loaded = trial.stdout.strip()
        if loaded.startswith("rmw_fastrtps"):
            return ok(name, f"{loaded}{' (RMW_IMPLEMENTATION)' if wanted else ''}")
        return warning(
            name,
            f"{loaded} (RMW_IMPLEMENTATION)",
            "Spinbook's loopback profile is for Fast DDS; other middlewares are only told LOCALHOST. "
            "For the default: unset RMW_IMPLEMENTATION",
        )
    if absent or trial.returncode == NOT_LOADED:
        return missing(
            name,
            f"RMW_IMPLEMENTATION is '{wanted}', which is not installed here",
            "Nodes would end without a word (exit code 102). unset RMW_IMPLEMENTATION",
        )
    lines = trial.stderr.strip().splitlines() or [f"exit code {trial.returncode}"]
    return missing(name, f"does not load: {lines[-1]}", "Make the environment anew: make setup")
