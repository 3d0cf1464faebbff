"""Runs a student's program where it can't see or harm anything else: see docs/sandbox.md.

server = ForkServer()  # once in a worker, before the processes that grade are forked
...
with server.start(ProgramSpec("node.py", {"node.py": source}, hub=socket), isolation) as student:
    ...
"""

from grader.sandbox.fork_server import ForkServer, SandboxedProgram
from grader.sandbox.isolation import available, choose
from grader.sandbox.middleware import MiddlewareUnavailable, require_middleware
from grader.sandbox.program import Isolation, Limits, ProgramSpec, SandboxError, SandboxUnavailable
from groundwork.process_exit import ProcessExit

__all__ = [
    "ForkServer",
    "Isolation",
    "Limits",
    "MiddlewareUnavailable",
    "ProcessExit",
    "ProgramSpec",
    "SandboxError",
    "SandboxUnavailable",
    "SandboxedProgram",
    "available",
    "choose",
    "require_middleware",
]
