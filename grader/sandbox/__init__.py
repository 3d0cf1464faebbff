"""Runs a student's program where it can't see or harm anything else: see docs/sandbox.md.

server = ForkServer([Middleware.LOCKSTEP])  # once in a worker, before the processes that grade are forked
...
with server.start(Program("node.py", {"node.py": source}, hub=socket), isolation) as student:
    ...
"""

from grader.sandbox.fork_server import ForkServer, Student
from grader.sandbox.isolation import Isolation, available, choose
from grader.sandbox.middleware import Choice, MiddlewareUnavailable, choose_middleware, to_be_compiled
from grader.sandbox.monitor import Exit, Output
from grader.sandbox.namespaces import enter
from grader.sandbox.program import Limits, Middleware, Program, SandboxError, SandboxUnavailable

__all__ = [
    "Choice",
    "Exit",
    "ForkServer",
    "Isolation",
    "Limits",
    "Middleware",
    "MiddlewareUnavailable",
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
