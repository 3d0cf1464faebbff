"""A world of MuJoCo's: sensors and commands are topics, a push is a step, and each run gives the same bits."""

from __future__ import annotations

import re
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from grader.exercise import ExerciseError, load
from grader.scenario.declared import declared
from grader.scenario.scenario import Scenario
from grader.scenario.store import from_plain, plain

pytest.importorskip("mujoco", reason="the extra physics is not installed")

DOCS = Path(__file__).parents[3] / "docs" / "scenarios.md"
TOML = """\
title = "Balance"
points = 1
file = "balance.py"
node = "balance"

[[subscribe]]
topic = "/angle"
type = "std_msgs/msg/Float64"
"""


def documented(folder: Path, old: str = "", new: str = "") -> Scenario:
    """Return the scenario of the documentation, with this change."""
    text = DOCS.read_text(encoding="utf-8").partition("### Physics")[2]
    (model,) = re.findall(r"^```xml\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    cart, pushed = re.findall(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL)[:2]
    exercise = folder / "exercises" / "balance"
    exercise.mkdir(parents=True)
    source = f"from grader.scenario import *\n\n{cart}\n{pushed}\n\ndef scenarios(seed):\n    return (PUSHED,)\n"
    assert old in source
    files = {"exercise.toml": TOML, "task.md": "# Balance\n", "cart.xml": model}
    for name, content in {**files, "scenarios.py": source.replace(old, new)}.items():
        (exercise / name).write_text(content)
    return declared(load(exercise), 1)[0]


def fall(scenario: Scenario, force: float, push: bool = False) -> Any:
    """Return the model after a second with this force on the cart."""
    assert scenario.world
    model: Any = scenario.world.begin()
    model.hear("/force", SimpleNamespace(data=force))
    if push:
        model.push(body="pole", force=(2.0, 0.0, 0.0), seconds=0.1)
    for _ in range(100):
        model.step(0.01)
    return model


def test_the_documented_example_falls_and_is_pushed_with_the_same_bits_each_time(tmp_path: Path) -> None:
    scenario = documented(tmp_path)
    assert scenario.steps[0].method == "push"  # type: ignore[attr-defined]
    again = from_plain(plain(scenario), tmp_path)
    assert again.digest == scenario.digest
    states = [fall(one, 1.0).state() for one in (scenario, again)]
    assert states[0] == states[1]
    assert states[0]["/joint_states"]["name"] == ["slide", "hinge"]
    assert states[0]["/angle"]["data"] == states[0]["/joint_states"]["position"][1]
    model = fall(scenario, 0.0)
    assert model.truth()["hinge"] > 0.5
    assert len(model.truth()["pole"]) == 3
    assert fall(scenario, 0.0, push=True).truth()["hinge"] != model.truth()["hinge"]
    assert fall(scenario, float("nan")).truth() == model.truth()


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('model="cart.xml"', 'model="car.xml"', "FileNotFoundError.*car.xml"),
        ('"/angle": "angle"', '"/angle": "angel"', "angel.*Valid names.*angle"),
        ('"/force": "force"', '"/force": "forc"', "forc.*Valid names.*'force'"),
        ('body="pole"', 'body="poll"', "the world's push fails.*poll"),
        ('world("push"', 'world("pull"', "the world's pull fails.*pull"),
        ("world=CART, ", "", "there is no world to push"),
    ],
)
def test_a_name_that_the_model_lacks_is_reported_with_its_line(
    tmp_path: Path, old: str, new: str, message: str
) -> None:
    with pytest.raises(ExerciseError) as caught:
        documented(tmp_path, old, new)
    assert re.search(message, caught.value.problem.problem), caught.value
    assert caught.value.problem.line
