"""A name in a check that the exercise does not have is found before anything runs, with line and the right one."""

from __future__ import annotations

from pathlib import Path

import pytest

from grader.checking.misspellings import misspellings
from grader.exercise import load
from grader.scenario.declared import declared

TOML = """\
title = "Names"
points = 1
file = "names.py"
node = "names"

[[subscribe]]
topic = "/scan"
type = "sensor_msgs/msg/Range"

[[subscribe]]
topic = "/tf"
type = "tf2_msgs/msg/TFMessage"

[[publish]]
topic = "/cmd_vel"
type = "geometry_msgs/msg/Twist"

[[service]]
name = "/switch"
type = "std_srvs/srv/SetBool"

[[action]]
name = "/count"
type = "test_msgs/action/Fibonacci"

[[parameter]]
name = "gain"
type = "double"
"""

SCENARIOS = """\
from grader.scenario import *


class Seen(Turtle):
    def truth(self):
        return {"level": 1.0, "x": 0.5}


def scenarios(seed):
    steps = (at(0.5).publish("/scan", range=1.0), at(1.0).subscribe("/cmd_vel", name="late"))
    return (Scenario("near", "", steps, duration=2.0, world=World(Seen)), Scenario("far", "", steps, duration=2.0))
"""

CHECKS = """\
from grader.checking import Run, check

SPEED, OTHER = "/cmd_vel", "/cmd_val"


@check(points=1, hint="")
def test_it(near: Run, far) -> None:
    run = near
    for one in (near, far):
        LINE
"""

LINE = 10


def problems(folder: Path, line: str) -> list[tuple[int | None, str]]:
    exercise = folder / "exercises" / "names"
    exercise.mkdir(parents=True)
    files = {"exercise.toml": TOML, "task.md": "# Names\n", "scenarios.py": SCENARIOS}
    for name, text in {**files, "checks.py": CHECKS.replace("LINE", line)}.items():
        (exercise / name).write_text(text)
    loaded = load(exercise)
    errors = [error.problem for error in misspellings(loaded, declared(loaded, 1))]
    assert all(error.file == exercise / "checks.py" for error in errors)
    return [(error.line, f"{error.problem}. {error.fix}") for error in errors]


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("near.must_publsh(SPEED)", "a run has no must_publsh. Did you mean must_publish?"),
        ("one.must_publish(SPEED, cont=1)", "must_publish has no argument cont. Did you mean count?"),
        ("near.must_publish(OTHER)", "there is no topic '/cmd_val'. Did you mean /cmd_vel?"),
        ("far.messages_on('/scam')", "there is no topic '/scam'. Did you mean /scan?"),
        ("near.must_reach('/turtle1/pos', {'x': 1.0}, 0.1, 2.0)", "Did you mean /turtle1/pose?"),
        ("near.must_reach('/turtle1/pose', {'z': 1.0}, 0.1, 2.0)", "turtlesim/msg/Pose has no field 'z'"),
        ("near.must_match('linear.0.x')", "`0` in `linear.0.x` is not a field. Write for example position[0]"),
        ("near.must_match('linear.w')", "geometry_msgs/msg/Twist has no field 'linear.w'"),
        ("near.must_match_series('liner.x', SPEED)", "'liner.x'. Did you mean linear?"),
        ("near.must_match_responses('sucess')", "SetBool.Response has no field 'sucess'. Did you mean success?"),
        ("near.must_match_results('seq')", "test_msgs/action/Fibonacci.Result has no field 'seq'"),
        ("near.must_respond('/swich')", "there is no service '/swich'. Did you mean /switch?"),
        ("near.goals(action='/cont')", "there is no action '/cont'. Did you mean /count?"),
        ("near.must_end('suceeded')", "there is no state 'suceeded'. Did you mean succeeded?"),
        ("near.must_take('gian', 1.0)", "there is no parameter 'gian'. Did you mean gain?"),
        ("near.must_match_series('linear.x', subscriber='lat')", "there is no subscriber 'lat'. Did you mean late?"),
        ("[m.linaer for m in near.messages_on(SPEED)]", "geometry_msgs/msg/Twist has no linaer. Did you mean linear?"),
        ("near.must_reach('truth', {'lvel': 1.0}, tolerance=1, within=1)", "the world's truth has no 'lvel'"),
        ("near.must_estimate('/cmd_vel', {'linear.x': 'levle'}, rmse=0.1)", "the world's truth has no 'levle'"),
        ("[m.stamp for m in near.messages_on(SPEED)]", "Twist has no stamp. There are: angular, linear"),
        ("each(near.messages_on(SPEED), lambda m: m.linaer)", "Twist has no linaer. Did you mean linear?"),
        ("[t.heder for m in near.messages_on('/tf') for t in m.transforms]", "TransformStamped has no heder"),
        ("near.received[0].angular.zz", "geometry_msgs/msg/Vector3 has no zz"),
        ("near.messages_on('/turtle1/pose')[-1].fields['thta']", "has no field 'thta'. Did you mean theta?"),
        ("near.must_reach('/turtle1/pose', {'x': 1.0}, 0.1)", "must_reach: missing a required argument: 'within'"),
        ("near.must_publish(SPEED, 1, 2)", "too many positional arguments. It is must_publish(topic=…, count=…)."),
        ("near.must_reach('/turtle1/pose', ['x', 1.0], 0.1, 2.0)", "gets ['x', 1.0] for place"),
        ("near.must_publish(SPEED, count='3')", "must_publish gets '3' for count. Write for example 2."),
        ("near.messages_on(SPEED, 'linear')", "messages_on gets 'linear' for reference. Write for example True."),
        ("near.must_have_interface", "near.must_have_interface is not called"),
        ("near.recording.gaols", "the record Recording has no gaols. Did you mean goals?"),
        ("[change.reson for change in near.recording.parameters]", "has no reson. Did you mean reason?"),
        ("[call.answerd for call in near.calls()]", "the record Call has no answerd. Did you mean answered?"),
        ("near.publishers(SPEED)[0].relibility", "the record Endpoint has no relibility. Did you mean reliability?"),
    ],
)  # fmt: skip
def test_a_misspelt_name_is_found_with_its_line(tmp_path: Path, line: str, message: str) -> None:
    found = problems(tmp_path, line)
    assert [number for number, _ in found] == [LINE], found
    assert message in found[0][1]


def test_what_is_right_or_not_known_is_not_reported(tmp_path: Path) -> None:
    right = """topic = '/x' if near.nodes else SPEED
        near.must_publish(topic), near.must_match_series("linear.x", SPEED), near.must_match("angular")
        near.must_reach("/turtle1/pose", {"x": 1.0, "y": 2.0}, 0.1, 2.0), near.must_stay_between("truth", "x", 0.0, 1.0)
        print([m.linear.x + m.at for m in near.messages_on()], near.sent[0].anything, run.whatever)
        call = near.calls("/switch")[0]
        print(call.request["data"], near.topics("publisher"), near.subscriptions("/clock"), near.recording.timeline)
        for goal in sorted(near.goals(), key=print):
            print(goal.states[0].state, goal.finished - goal.at, call.answered_ns)"""
    assert problems(tmp_path, right) == []
