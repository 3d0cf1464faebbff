"""Runs a test of a chapter's nodes again if rclpy itself was at fault."""

from __future__ import annotations

import inspect

import pytest
from fault_of_rclpy import FaultOfRclpy

#: A chapter whose node ends like this each time is at fault itself.
_TRIES = 5


@pytest.hookimpl(tryfirst=True)
def pytest_pyfunc_call(pyfuncitem: pytest.Function) -> bool:
    arguments = {name: pyfuncitem.funcargs[name] for name in inspect.signature(pyfuncitem.obj).parameters}
    for _ in range(_TRIES - 1):
        try:
            pyfuncitem.obj(**arguments)
        except FaultOfRclpy:
            continue
        return True
    pyfuncitem.obj(**arguments)
    return True
