"""What the package's tests share: a ROS domain of their own, and no deadline on busy machines."""

from __future__ import annotations

import os
import signal

from fixtures import only_here as only_here
from fixtures import ros_domain as ros_domain
from hypothesis import settings


def pytest_configure() -> None:
    # Started in a shell's background, tests would make every program that they start ignore Ctrl-C.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    # numpy would start a thread for each CPU in each process.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    settings.register_profile("no deadline", deadline=None)
    settings.load_profile("no deadline")
