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
    QosPolicies,
    compatible,
    first_mismatch,
)


@pytest.mark.parametrize(
    ("weak", "strong", "policy"),
    [
        (QosPolicies(reliability=BEST_EFFORT), QosPolicies(), RELIABILITY),
        (QosPolicies(), QosPolicies(durability=TRANSIENT_LOCAL), DURABILITY),
        (QosPolicies(), QosPolicies(liveliness=MANUAL_BY_TOPIC), LIVELINESS),
        (QosPolicies(lease=2), QosPolicies(lease=1), LIVELINESS),
        (QosPolicies(deadline=2), QosPolicies(deadline=1), DEADLINE),
        (QosPolicies(deadline=0), QosPolicies(deadline=1), DEADLINE),
    ],
)
def test_a_weaker_offer_does_not_satisfy_and_a_stronger_one_does(
    weak: QosPolicies, strong: QosPolicies, policy: int
) -> None:
    assert first_mismatch(weak, strong) == policy
    assert not compatible(weak, strong)
    assert compatible(strong, weak)


def test_of_several_policies_the_first_is_named() -> None:
    assert first_mismatch(QosPolicies(reliability=BEST_EFFORT), QosPolicies(durability=TRANSIENT_LOCAL)) == DURABILITY


def test_qos_hashes_and_the_hub_need_neither_a_library_nor_a_compiler() -> None:
    code = "import sys; sys.modules['rmw_lockstep.library'] = None; import rmw_lockstep.hub, rmw_lockstep.type_hash"
    subprocess.run([sys.executable, "-c", code], check=True)
