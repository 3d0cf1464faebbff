"""The guide to writing exercises shows what the templates really hold, and every kind has its page."""

from __future__ import annotations

import re
import textwrap
from pathlib import Path

import pytest

from spinbook.new.kind import KINDS, Kind

DOCS = Path(__file__).parents[2] / "docs"
FENCE = re.compile(r"^```(?:python|toml)\n(.*?)^```", re.MULTILINE | re.DOTALL)
OF_KIND = [pytest.param(kind, id=kind.name) for kind in KINDS]


def flat(text: str) -> str:
    """The text without indentation, which differs where an example was taken out of a function."""
    return "\n".join(line.strip() for line in textwrap.dedent(text).strip().splitlines())


def files_of(kind: Kind) -> str:
    """Everything that the template's author files hold."""
    return "\n".join(flat(file.read_text()) for file in (kind.root / "exercises" / kind.exercise).glob("*.*"))


@pytest.mark.parametrize("kind", OF_KIND)
def test_every_example_stands_in_the_template_which_is_graded(kind: Kind) -> None:
    page = (DOCS / "writing-exercises" / f"{kind.name}.md").read_text()
    examples = FENCE.findall(page)
    assert len(examples) >= 3
    for example in examples:
        assert flat(example) in files_of(kind), example


@pytest.mark.parametrize("kind", OF_KIND)
def test_every_page_names_its_command(kind: Kind) -> None:
    page = (DOCS / "writing-exercises" / f"{kind.name}.md").read_text()
    assert f"--kind {kind.name}" in page


def test_the_guide_links_every_page_and_its_examples_stand_in_a_template() -> None:
    guide = (DOCS / "writing-exercises.md").read_text()
    assert [kind.name for kind in KINDS if f"(writing-exercises/{kind.name}.md)" not in guide] == []
    everything = "\n".join(files_of(kind) for kind in KINDS)
    assert all(flat(example) in everything for example in FENCE.findall(guide))
