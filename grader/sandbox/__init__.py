"""Runs a student's program where it can neither see nor harm anything: see docs/sandbox.md.

nursery = Nursery()                       # once in a worker, before the rigs are forked
...
enter(isolation)                          # in the rig, freshly forked
with nursery.start(Program("node.py", {"node.py": source}), isolation) as student:
    ...
"""

from .level import Isolation, SandboxError, SandboxUnavailable, available, choose
from .limits import Limits
from .nursery import Nursery
from .output import Output
from .program import Program
from .rig_namespace import enter
from .student import Student
from .warden import Exit

__all__ = [
    "Exit",
    "Isolation",
    "Limits",
    "Nursery",
    "Output",
    "Program",
    "SandboxError",
    "SandboxUnavailable",
    "Student",
    "available",
    "choose",
    "enter",
]
