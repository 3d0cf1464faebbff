"""Loads what message types need, so that every fork finds it in its memory."""

from __future__ import annotations

import contextlib
import importlib
import inspect


def load(name: str) -> None:
    """Imports a module of message or service types, loads their compiled support, and the middleware's for messages.

    What can't be loaded is left out: it fails in the same way where it is used.
    """
    try:
        module = importlib.import_module(name)
        from rclpy.serialization import serialize_message
    except ImportError:
        return
    for _, kind in inspect.getmembers(module, inspect.isclass):
        load_own = getattr(kind, "__import_type_support__", None)
        if load_own is not None:
            with contextlib.suppress(Exception):
                load_own()
                if name.endswith(".msg"):
                    serialize_message(kind())
