"""Each chapter says how long its sections take."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

CHAPTERS = Path(__file__).parents[2] / "chapters"
#: What each chapter says about the whole: minutes, rounded to half an hour as the words are.
WHOLE = {"03-nodes-and-topics": 180, "04-services-and-actions": 210, "05-parameters-and-qos": 180}
UNTIMED = ("Practice", "What comes next", "Where you are now")


@pytest.mark.parametrize("name", WHOLE)
def test_the_table_of_times_names_every_section_and_adds_up(name: str) -> None:
    text = (CHAPTERS / f"{name}.md").read_text(encoding="utf-8")
    sections = re.findall(r"^## (.+)$", text, re.MULTILINE)
    table = text.split("| Section | Minutes |")[1].split("\n\n")[0]
    timed = re.findall(r"\[([^\]]+)\]\(#", table)
    assert [section for section in sections if not section.startswith(UNTIMED)] == timed
    minutes = sum(map(int, re.findall(r"\| (\d+) \|$", table, re.MULTILINE)))
    assert abs(minutes - WHOLE[name]) <= 10
