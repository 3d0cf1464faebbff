"""Every example of docs/scenarios.md is read by the grader without an error."""

from __future__ import annotations

import re
from pathlib import Path

from grader.exercise import load
from grader.scenario.declared import declared

DOCS = Path(__file__).parents[3] / "docs" / "scenarios.md"

#: What the examples assume.
TOML = """
title = "All of them"
points = 1
file = "all.py"
[[service]]
name = "/add"
type = "example_interfaces/srv/AddTwoInts"
[[action]]
name = "/count"
type = "test_msgs/action/Fibonacci"
[[program]]
file = "leader.py"
node = "leader"
[[program]]
file = "robot.py"
node = "robot"
"""


def fences(language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", DOCS.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)


def exercise_in(folder: Path, toml: str, scenarios: str) -> Path:
    exercise = folder / "exercises" / "documented"
    exercise.mkdir(parents=True)
    (exercise / "exercise.toml").write_text(toml, encoding="utf-8")
    (exercise / "task.md").write_text("# All of them\n", encoding="utf-8")
    (exercise / "scenarios.py").write_text(scenarios, encoding="utf-8")
    return exercise


def test_the_examples_of_scenarios_can_be_read(tmp_path: Path) -> None:
    definitions = [text for text in fences("python") if text.startswith(("class ", "from "))]
    examples = [text for text in fences("python") if text not in definitions]
    lines = [line.partition("  #")[0] for text in examples for line in text.splitlines()]
    found = [line for line in lines if line.startswith("Scenario(")]
    assert len(found) == 7
    assert sum(line.startswith(("Server(", "ActionServer(")) for line in lines) == 7
    servers = ",\n".join(line for line in lines if line.startswith(("Server(", "ActionServer(")))
    source = "\n\n".join(
        [
            "from grader.scenario import *",
            "def add(request): return {'sum': 0}",
            *definitions,
            *(line for line in lines if line.startswith(("LEFT", "RIGHT"))),
            f"SERVERS = ({servers})",
            "first = scenarios",
            f"def scenarios(seed): return (*first(seed), {', '.join(found)})",
        ]
    )
    names = [one.name for one in declared(load(exercise_in(tmp_path, TOML, source)), 1)]
    assert names == ["calls", "active", "corner", "reach", "tank", "late", "killed", "two"]


def test_the_example_of_an_interface_can_be_read(tmp_path: Path) -> None:
    (toml,) = fences("toml")
    exercise = load(exercise_in(tmp_path, toml.replace("scipy", "PyYAML"), ""))
    assert exercise.reference_node == "leader"
    assert exercise.topics[0].elements
    assert [one.name for one in exercise.parameters] == ["gain"]


def test_every_step_in_the_table_is_one(tmp_path: Path) -> None:
    from grader.scenario.steps import At

    named = set(re.findall(r"at\([\d.]+\)\.(\w+)\(", DOCS.read_text(encoding="utf-8")))
    assert named == {name for name in vars(At) if not name.startswith("_")}
