"""How to grade."""

from __future__ import annotations

import os
from dataclasses import dataclass, field

from grader.sandbox import Isolation, Limits, Middleware


@dataclass(frozen=True)
class Options:
    """How to grade. `isolation` None means the strongest that works here, `middleware` None lockstep if it can be had.

    `seed` chooses the numbers of scenarios that have chance in them. `pace` is 1.0 for the pace of real time, None for
    as fast as it goes.

    `parallel` is how many spins run at once: more than there are cores, for much of a spin is waiting.
    `core` is the CPU to keep the program on; None lets its spins take turns on all of them.
    """

    isolation: Isolation | None = None
    seed: int = 1
    pace: float | None = None
    parallel: int = field(default_factory=lambda: max(2, min(8, 2 * len(os.sched_getaffinity(0)))))
    limits: Limits = field(default_factory=Limits)
    core: int | None = None
    middleware: Middleware | None = None
