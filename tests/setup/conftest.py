"""A checkout to set up."""

from __future__ import annotations

from pathlib import Path

import pytest
from setup_stage import Checkout, make_checkout


@pytest.fixture
def checkout(tmp_path: Path) -> Checkout:
    """A checkout that was never set up."""
    return make_checkout(tmp_path)
