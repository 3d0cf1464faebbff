"""Runs a student's program where it can neither see nor harm anything: see docs/sandbox.md.

nursery = Nursery([Middleware.LOCKSTEP])  # once in a worker, before the processes that grade are forked
...
with nursery.start(Program("node.py", {"node.py": source}, hub=socket), isolation) as student:
    ...
"""

from .faults import SandboxError, SandboxUnavailable
from .level import Isolation, available, choose
from .limits import Limits
from .middleware import Choice, Middleware, MiddlewareUnavailable, choose_middleware, to_be_compiled
from .nursery import Nursery
from .output import Output
from .program import Program
from .rig_namespace import enter
from .student import Student
from .warden import Exit

__all__ = [
    "Choice",
    "Exit",
    "Isolation",
    "Limits",
    "Middleware",
    "MiddlewareUnavailable",
    "Nursery",
    "Output",
    "Program",
    "SandboxError",
    "SandboxUnavailable",
    "Student",
    "available",
    "choose",
    "choose_middleware",
    "enter",
    "to_be_compiled",
]
