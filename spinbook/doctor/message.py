"""Whether a message gets from one process to another, as it does between the nodes of a notebook."""

from __future__ import annotations

import json
import os
import subprocess
import sys

from spinbook.doctor.finding import Finding, missing, ok
from spinbook.kernel import environment as domain
from spinbook.kernel.environment import for_domain, missing_middleware

_DEADLINE_S = 30.0


def examine(name: str) -> Finding:
    """Start a publisher and a subscriber as processes, in a ROS domain of their own, on this machine's loopback."""
    inherited = dict(os.environ)
    if missing_middleware(inherited):
        del inherited["RMW_IMPLEMENTATION"]
    claimed = domain.claim_domain()
    try:
        environment = inherited | for_domain(claimed.number, inherited)
        took = _send_one(environment)
    except subprocess.TimeoutExpired:
        return missing(
            name,
            f"none arrived within {_DEADLINE_S:g} s (domain {claimed.number}, 127.0.0.1)",
            "Is the loopback interface up (ip link show lo)? Does a firewall drop UDP on 127.0.0.1?",
        )
    except subprocess.CalledProcessError as error:
        lines = (error.stderr or "").strip().splitlines() or [f"exit code {error.returncode}"]
        return missing(
            name, f"the listener failed: {lines[-1]}", "Its whole output: python -m spinbook.doctor.talk listen"
        )
    finally:
        claimed.release()
    return ok(
        name,
        f"arrived from another process in {took['travel_s'] * 1e3:.1f} ms; they had found each other "
        f"after {took['meeting_s'] * 1e3:.0f} ms",
    )


def _send_one(environment: dict[str, str]) -> dict[str, float]:
    talker = subprocess.Popen(
        [sys.executable, "-m", "spinbook.doctor.talk"],
        env=environment,
        stdin=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        listener = subprocess.run(
            [sys.executable, "-m", "spinbook.doctor.talk", "listen"],
            env=environment,
            capture_output=True,
            text=True,
            timeout=_DEADLINE_S,
            check=True,
        )
    finally:
        talker.kill()
        talker.communicate()
    took = json.loads(listener.stdout)
    assert isinstance(took, dict)
    return took
