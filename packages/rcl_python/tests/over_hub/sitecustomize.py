"""Lets a Python process run its nodes over rcl_python, joined to the hub that RCL_PYTHON_HUB names."""

import os

if "RCL_PYTHON_HUB" in os.environ:
    from hub_of_processes import SocketLink

    import rcl_python
    from rcl_python import participant

    identity = f"p{os.getpid()}"
    participant.use(SocketLink(os.environ["RCL_PYTHON_HUB"], identity), identity)
    rcl_python.install()
