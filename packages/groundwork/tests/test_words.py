"""What is counted has the right plural."""

from __future__ import annotations

from groundwork.words import counted


def test_a_number_has_its_noun_in_the_right_form() -> None:
    numbers = [counted(1, "day"), counted(2, "day"), counted(0, "entry"), counted(1, "entry")]

    assert numbers == ["1 day", "2 days", "0 entries", "1 entry"]
