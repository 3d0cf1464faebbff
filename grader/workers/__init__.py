"""Trusted processes that do the work of grading: they run submissions in scenarios, and judge them."""

from grader.workers.pool import HostFault, Worker, WorkerPool

__all__ = ["HostFault", "Worker", "WorkerPool"]
