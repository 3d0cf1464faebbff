"""A secret is found wherever it is in a file, among thousands of others."""

from __future__ import annotations

import random

import pytest

from spinbook.handout.leaks import Secret, leaks

ALPHABET = "abc"


def some_text(random_of: random.Random, length: int) -> str:
    return "".join(random_of.choice(ALPHABET) for _ in range(length))


@pytest.mark.parametrize("length", [1, 19, 20, 21, 39, 40, 41, 100])
def test_a_secret_of_any_length_is_found_at_any_place(length: int) -> None:
    random_of = random.Random(length)
    secret = Secret("it", "x" + some_text(random_of, length - 1))
    for before in range(45):
        text = some_text(random_of, before) + secret.text + some_text(random_of, 30)
        assert list(leaks({"file.md": text.encode()}, [secret])) == [("file.md", "it")], before
        assert list(leaks({"file.md": text.replace("x", "").encode()}, [secret])) == []


def test_the_same_is_found_as_by_looking_for_each_secret_by_itself() -> None:
    random_of = random.Random(1)
    text = some_text(random_of, 3000)
    places = [(random_of.randrange(2900), random_of.randrange(1, 100)) for _ in range(500)]
    inside = [Secret(f"inside {number}", text[at : at + length]) for number, (at, length) in enumerate(places)]
    elsewhere = [Secret(f"elsewhere {number}", some_text(random_of, 60)) for number in range(500)]
    known = random_of.sample(inside + elsewhere, 1000)

    found = [what for _, what in leaks({"file.md": text.encode()}, known)]

    assert found == [secret.what for secret in known if secret.text in text]
    assert len(found) >= 500
