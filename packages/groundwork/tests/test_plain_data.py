"""Dataclasses are made again from plain data."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from datetime import datetime, timezone

import pytest

from groundwork.plain_data import restored


@dataclass(frozen=True)
class Wheel:
    radius: float
    name: str = ""


@dataclass(frozen=True)
class Cart:
    wheels: tuple[Wheel, ...]
    spare: Wheel | None = None
    by_side: dict[str, Wheel] = field(default_factory=dict)
    sizes: tuple[int, ...] = ()
    notes: dict[str, list[int]] = field(default_factory=dict)
    built: datetime | None = None


def test_what_was_made_plain_is_equal_when_it_is_made_again() -> None:
    cart = Cart((Wheel(0.5, "left"), Wheel(0.4)), Wheel(1.0), {"left": Wheel(0.5)}, (1, 2), {"a": [3]})
    assert restored(Cart, json.loads(json.dumps(asdict(cart)))) == cart


def test_times_are_read_and_missing_entries_have_their_defaults() -> None:
    built = datetime(2026, 11, 22, tzinfo=timezone.utc)
    assert restored(Cart, {"wheels": [], "built": built.isoformat()}) == Cart((), built=built)


@pytest.mark.parametrize(
    "entries", [{}, {"wheels": 1}, {"wheels": [1]}, {"wheels": [], "axles": 2}, {"wheels": [{}]}, []]
)
def test_other_data_is_an_error(entries: object) -> None:
    with pytest.raises((TypeError, KeyError, ValueError)):
        restored(Cart, entries)  # type: ignore[arg-type]
