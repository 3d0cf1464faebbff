"""`ros2 doctor hello` counts what it says, and what other computers say."""

from __future__ import annotations

import socket

import pytest
from click.testing import CliRunner

from ros_in_python.ros2 import hello

pytestmark = pytest.mark.usefixtures("ros_domain")


def test_the_table_counts_what_is_said_and_other_computers(monkeypatch: pytest.MonkeyPatch) -> None:
    # This computer hears itself, too, and does not count that: so it gets another name after each greeting.
    names = iter(f"robot{number}" for number in range(1000))
    monkeypatch.setattr(socket, "gethostname", lambda: next(names))
    answer = CliRunner().invoke(hello.hello, ["--once", "--emit-period", "0.5"])
    if "Multicast can't be used here" in answer.output:
        pytest.skip("no multicast on this machine")
    lines = answer.output.splitlines()
    assert lines[:3] == [
        "MULTIMACHINE COMMUNICATION SUMMARY",
        "Topic: /canyouhearme, Published Msg Count: 1",
        "Subscribed from:",
    ]
    assert "Multicast Group/Port: 225.0.0.1/49150, Sent Msg Count: 1" in lines
    assert any(line.split() == ["robot1", "1"] for line in lines[lines.index("Received from:") :])
