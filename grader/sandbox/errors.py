"""What goes wrong with sandboxes, by no fault of any student's."""

from __future__ import annotations


class SandboxUnavailable(Exception):
    """This machine does not allow the sandbox or the middleware that was wanted, or none at all."""


class SandboxError(Exception):
    """A sandbox could not be made or ended: a fault of ours or the machine's, never of the student."""
