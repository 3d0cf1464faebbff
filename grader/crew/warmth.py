"""What every spin needs is found and loaded once in the worker, not again in each process that it forks."""

from __future__ import annotations

import functools
import gc

from grader.crew.environment import PROFILE
from grader.sandbox import type_support, view
from interface_compiler import activation

#: Whose compiled support the rig uses in every spin; loading it takes half as long as a short scenario.
PACKAGES = (
    *("rcl_interfaces.msg", "rcl_interfaces.srv", "type_description_interfaces.srv", "builtin_interfaces.msg"),
    *("rosgraph_msgs.msg", "std_msgs.msg", "sensor_msgs.msg", "geometry_msgs.msg"),
)


def warm() -> None:
    """Load message types, look at the file system, and leave the memory as it is shared best with forks."""
    for package in (*PACKAGES, *(f"{name}.msg" for name in activation.active_packages())):
        type_support.load(package)
    view.steps((PROFILE,), (), 0)
    _share()


@functools.cache
def warm_to_judge() -> None:
    """The same for what judging needs besides."""
    from grader.checking.judging import load_pytest

    load_pytest()
    _share()


def _share() -> None:
    # Collected later, in each fork, it would be copied there.
    gc.collect()
    gc.freeze()
