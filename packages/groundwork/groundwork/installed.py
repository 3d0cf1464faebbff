"""What pip has installed in this environment."""

from __future__ import annotations

import contextlib
from importlib import metadata


def version_of(*distributions: str, otherwise: str) -> str:
    """Return the version of the first of these distributions that is installed."""
    for name in distributions:
        with contextlib.suppress(metadata.PackageNotFoundError):
            return metadata.version(name)
    return otherwise
