"""Which offers satisfy which requests, and which policy is named otherwise. It needs no compiled library."""

from __future__ import annotations

import subprocess
import sys

import pytest

from rmw_lockstep.qos import (
    BEST_EFFORT,
    DEADLINE,
    DURABILITY,
    LIVELINESS,
    MANUAL_BY_TOPIC,
    RELIABILITY,
    TRANSIENT_LOCAL,
    Qos,
    compatible,
    first_mismatch,
)


@pytest.mark.parametrize(
    ("weak", "strong", "policy"),
    [
        (Qos(reliability=BEST_EFFORT), Qos(), RELIABILITY),
        (Qos(), Qos(durability=TRANSIENT_LOCAL), DURABILITY),
        (Qos(), Qos(liveliness=MANUAL_BY_TOPIC), LIVELINESS),
        (Qos(lease=2), Qos(lease=1), LIVELINESS),
        (Qos(deadline=2), Qos(deadline=1), DEADLINE),
        (Qos(deadline=0), Qos(deadline=1), DEADLINE),
    ],
)
def test_a_weaker_offer_does_not_satisfy_and_a_stronger_one_does(weak: Qos, strong: Qos, policy: int) -> None:
    assert first_mismatch(weak, strong) == policy
    assert not compatible(weak, strong)
    assert compatible(strong, weak)


def test_of_several_policies_the_first_is_named() -> None:
    assert first_mismatch(Qos(reliability=BEST_EFFORT), Qos(durability=TRANSIENT_LOCAL)) == DURABILITY


def test_qos_hashes_and_the_hub_need_neither_a_library_nor_a_compiler() -> None:
    code = "import sys; sys.modules['rmw_lockstep.library'] = None; import rmw_lockstep.hub, rmw_lockstep.type_hash"
    subprocess.run([sys.executable, "-c", code], check=True)
