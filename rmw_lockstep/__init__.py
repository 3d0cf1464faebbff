"""A ROS 2 middleware (RMW) without a network, in which one hub knows when every program has nothing left to do.

README.md says what it is for, PROTOCOL.md how programs and the hub talk.
"""

from __future__ import annotations
