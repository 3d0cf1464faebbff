"""The hostile submissions and their expected results match each other."""

from __future__ import annotations

import ast
import sys
from pathlib import Path
from typing import Any

import pytest

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

FOLDER = Path(__file__).parent
EXPECTED: dict[str, dict[str, Any]] = tomllib.loads((FOLDER / "expected.toml").read_text())
SUBMISSIONS = {path.stem: path for path in (FOLDER / "submissions").glob("*.py")}

OUTCOMES = {"graded", "did-not-start", "crashed", "timed-out", "over-limit"}
NOT_PYTHON = {"binary_rubbish", "deeply_nested", "empty_file", "not_utf8", "null_bytes", "syntax_error"}


def test_each_submission_has_its_expectation_and_the_other_way_round() -> None:
    assert set(EXPECTED) == set(SUBMISSIONS)


def test_there_are_enough_of_them() -> None:
    assert len(SUBMISSIONS) >= 40


@pytest.mark.parametrize("name", sorted(EXPECTED))
def test_each_expectation_can_be_understood(name: str) -> None:
    expectation = EXPECTED[name]

    assert set(expectation) <= {"outcome", "score", "words", "never"}
    assert set(expectation["outcome"]) <= OUTCOMES
    assert expectation["outcome"]
    assert expectation["score"] in {"zero", "full", "less", "any"}


@pytest.mark.parametrize("name", sorted(set(SUBMISSIONS) - NOT_PYTHON))
def test_each_submission_says_what_it_tries(name: str) -> None:
    words = ast.get_docstring(ast.parse(SUBMISSIONS[name].read_bytes()))

    assert words is not None
    assert words.endswith(".")
