"""Runs the checks beside one another, each in a process that may crash or hang without harm to the rest."""

from __future__ import annotations

import contextlib
import json
import subprocess
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor

import psutil

from spinbook.doctor.checks import Check
from spinbook.doctor.finding import Finding, State, missing

#: They mostly wait for processes to start.
_AT_ONCE = 4


def diagnose(checks: Sequence[Check], done: Callable[[Finding], None]) -> list[Finding]:
    """The findings in the order of `checks`; `done` is called with each as it comes."""

    started: dict[str, Future[Finding]] = {}

    def one(check: Check, needed: list[Future[Finding]]) -> Finding:
        amiss = [need.result().name for need in needed if need.result().state is State.MISSING]
        finding = missing(check.name, f"not tried, because of: {', '.join(amiss)}", "") if amiss else examine(check)
        done(finding)
        return finding

    with ThreadPoolExecutor(_AT_ONCE) as pool:
        # What is needed stands earlier in the list, so it never queues behind what waits for it.
        for check in checks:
            started[check.word] = pool.submit(one, check, [started[word] for word in check.needs if word in started])
        return [future.result() for future in started.values()]


def examine(check: Check) -> Finding:
    """Run one check, whatever happens to it."""
    argv = [sys.executable, "-m", "spinbook.doctor.examine", check.module, check.name]
    process = subprocess.Popen(
        argv,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        errors="replace",
        start_new_session=True,
    )
    try:
        out, err = process.communicate(timeout=check.seconds)
    except subprocess.TimeoutExpired:
        _end_all(process)
        return missing(
            check.name,
            f"no answer within {check.seconds:g} s",
            f"Try it alone, on a machine that is less busy: spinbook doctor {check.word}",
        )
    try:
        fields = json.loads(out)
        return Finding(fields["name"], State(fields["state"]), fields["found"], fields["mend"])
    except (ValueError, KeyError, TypeError):
        return missing(
            check.name, _how_it_ended(process.returncode, err), "See the message; docs/installing.md may help."
        )


def _how_it_ended(code: int, err: str) -> str:
    how = f"signal {-code}" if code < 0 else f"exit code {code}"
    lines = [line.strip() for line in err.splitlines() if line.strip()]
    return f"the check ended with {how}" + (f": {lines[-1]}" if lines else "")


def _end_all(process: subprocess.Popen[str]) -> None:
    """End a check and all that it has started."""
    with contextlib.suppress(psutil.NoSuchProcess):
        family = psutil.Process(process.pid).children(recursive=True)
        for member in family:
            with contextlib.suppress(psutil.NoSuchProcess):
                member.kill()
    process.kill()
    process.communicate()
