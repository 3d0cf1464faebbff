"""Whether a Jupyter kernel starts, runs a cell and knows Spinbook's commands."""

from __future__ import annotations

import sys
import time
from typing import Any

from spinbook.doctor.finding import Finding, missing, ok

_DEADLINE_S = 45.0
_CELL = "%load_ext spinbook\nimport sys; print(sys.prefix)"


def examine(name: str) -> Finding:
    """Start the kernel that the notebooks name, and run a cell in it."""
    try:
        from jupyter_client.manager import start_new_kernel
    except ImportError as error:
        return missing(name, str(error), "Make the environment anew: make setup")
    start = time.monotonic()
    try:
        manager, client = start_new_kernel(kernel_name="python3", startup_timeout=_DEADLINE_S)
    except (OSError, RuntimeError) as error:
        return missing(
            name,
            f"does not start: {error}",
            "Run it by hand to see why: python -m ipykernel\nJupyter keeps files below HOME: can you write there?",
        )
    try:
        printed, fault = _run(client)
    finally:
        client.stop_channels()
        manager.shutdown_kernel(now=True)
    took = time.monotonic() - start
    if fault:
        return missing(name, f"a cell fails: {fault}", "Make the environment anew: make setup")
    if printed.strip().splitlines()[-1:] != [sys.prefix]:
        return missing(name, f"another Python answers: {printed.strip()}", "jupyter kernelspec remove python3")
    return ok(name, f"started and ran a cell in {took:.1f} s")


def _run(client: Any) -> tuple[str, str]:
    """What the cell printed, and what went wrong."""
    printed: list[str] = []

    def keep(message: dict[str, Any]) -> None:
        if message["msg_type"] == "stream" and message["content"]["name"] == "stdout":
            printed.append(message["content"]["text"])

    reply = client.execute_interactive(_CELL, timeout=_DEADLINE_S, output_hook=keep)["content"]
    fault = "" if reply["status"] == "ok" else f"{reply.get('ename')}: {reply.get('evalue')}"
    return "".join(printed), fault
