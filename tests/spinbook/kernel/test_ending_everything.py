"""Whatever a notebook's process has started ends with it, however it is nested."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from spinbook.kernel.process import KeptProcess

#: A first process of a PID namespace, and a second one that was put there from outside, by a process that has ended.
NESTED = """
import pathlib, signal, subprocess, time
outside = subprocess.Popen(["unshare", "--user", "--map-root-user", "--pid", "--fork", "sleep", "1000"])
def children(pid): return pathlib.Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
def is_asleep(pid): return pathlib.Path(f"/proc/{pid}/comm").read_text() == "sleep\\n"
while not (first := children(outside.pid)) or not is_asleep(first[0]): time.sleep(0.01)
entering = subprocess.Popen(["nsenter", "--user", "--pid", "--target", first[0], "sleep", "1000"])
while not (second := children(entering.pid)) or not is_asleep(second[0]): time.sleep(0.01)
entering.kill()
entering.wait()
print("ready", flush=True)
signal.pause()
"""


def has_namespaces() -> bool:
    """Whether this machine lets its users make PID namespaces."""
    command = ["unshare", "--user", "--map-root-user", "--pid", "--fork", "true"]
    return subprocess.run(command, capture_output=True, check=False).returncode == 0


@pytest.mark.skipif(not has_namespaces(), reason="this machine does not let its users make namespaces")
@pytest.mark.timeout(60)
def test_a_pid_namespace_that_was_entered_from_outside_ends_too(tmp_path: Path) -> None:
    (tmp_path / "nested.py").write_text(NESTED)
    kept = KeptProcess([sys.executable, "nested.py"], os.environ, tmp_path)
    printed = b""
    while b"ready" not in printed:
        printed += kept.read()[0]
    assert len(kept.descendants()) == 4, "the program, unshare, and two in the namespace"

    kept.stop((0, 0))

    assert kept.wait(30).ended_by == "SIGKILL"
    assert kept.descendants() == []
    kept.close()
