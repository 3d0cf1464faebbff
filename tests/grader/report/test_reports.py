"""Reports survive whatever a student publishes, and are the same each time."""

from __future__ import annotations

import io
import json
import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from few_scenarios import in_scenarios
from jsonschema import Draft202012Validator
from rich.console import Console

from grader.checking import Run
from grader.checking.verdict import Wrong
from grader.grading import Grade
from grader.grading.grading import Grading
from grader.report.as_json import as_json
from grader.report.plot import draw
from grader.report.terminal import show
from grader.submission.reader import of_source

SCHEMA = Path(__file__).parents[3] / "docs" / "grade.schema.json"

HOSTILE = """
    def publish_velocities(self, message, positions, dt):
        answer = JointState(header=message.header)
        answer.name = ['$\\\\frac{', '\\x1b[2J\\x1b]0;owned\\x07', '<script>', 'a' * 1000, 'left_elbow', 'b', 'c']
        answer.velocity = [float('nan'), float('inf'), 1e308, -1e308, -0.0, 5e-324, 1.0]
        self.publisher.publish(answer)

    def unused(self, message, positions, dt):"""


@pytest.fixture(scope="module")
def hostile(grading: Grading) -> Grade:
    """A node that publishes names and numbers made to break whatever shows them."""
    solution = grading.runner.exercise.solution_file
    assert solution
    source = solution.read_text(encoding="utf-8")
    source = source.replace("\n    def publish_velocities(self, message, positions, dt):", HOSTILE)
    chapter = in_scenarios(grading, "chapter")
    return chapter.grade(of_source("\x1b[31mmine.py", source.encode(), grading.runner.exercise))


def test_the_terminal_shows_no_control_codes_of_a_students(hostile: Grade, grading: Grading) -> None:
    text = io.StringIO()
    show(hostile, grading.runner.exercise, Console(file=text, force_terminal=False), verbose=True)
    assert "\x1b" not in text.getvalue()
    assert "left_shoulder_pitch" in text.getvalue()


def test_the_json_is_json_and_as_the_schema_says(hostile: Grade) -> None:
    grade = json.loads(as_json(hostile))
    assert grade["outcome"] == "graded"
    assert "unknown" not in grade["versions"].values()
    schema = json.loads(SCHEMA.read_text(encoding="utf-8"))
    Draft202012Validator({"$defs": schema["$defs"], "$ref": "#/$defs/grade"}).validate(grade)


def test_what_a_check_expected_is_text_whatever_its_author_gives(hostile: Grade, grading: Grading) -> None:
    run = Run(grading.runner.exercise, hostile.recordings["chapter"], hostile.references["chapter"], "a title")
    with pytest.raises(Wrong) as caught:
        run.wrong(run.exchanges[1], "too few.", "left_elbow", expected=6, got=5)
    finding = caught.value.finding
    assert (finding.expected, finding.got, finding.message) == ("6", "5", 2)
    assert finding.text == "Message 2 of 100 (0.10 s after the start; a title), left_elbow: too few. Expected 6, got 5."


def test_the_plot_is_a_picture_and_the_same_each_time(hostile: Grade, grading: Grading, tmp_path: Path) -> None:
    for name in ("a.svg", "b.svg"):
        draw(hostile, grading.runner.exercise, tmp_path / name)
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()
    assert ET.parse(tmp_path / "a.svg").getroot().tag.endswith("svg")
