"""What is wrong in scenarios.py is reported with its line; none of it is blamed on the machine."""

from __future__ import annotations

import re
from importlib import metadata
from pathlib import Path

import pytest

from grader.checking.ending_message import message_of
from grader.exercise import ExerciseError, load
from grader.exercise.writing import to_toml
from grader.recording import Ending
from grader.scenario.code import AuthorCode
from grader.scenario.declared import declared
from grader.scenario.scenario import Scenario
from grader.scenario.store import NotForStudents, from_plain, plain
from grader.scenario.world import World

TOML = """\
title = "Any kind"
points = 10
file = "any_kind.py"
node = "any_kind"
reference_node = "world"

[[subscribe]]
topic = "/in"
type = "std_msgs/msg/Float64"

[[publish]]
topic = "/joints"
type = "sensor_msgs/msg/JointState"
depth = 5
reliability = "best_effort"
durability = "transient_local"
units = { position = "rad" }
elements = { called = "joint", named_by = "name" }

[[service]]
name = "/switch"
type = "std_srvs/srv/SetBool"

[[client]]
name = "/lamp"
type = "std_srvs/srv/SetBool"
units = { success = "1" }

[[action]]
name = "/count"
type = "test_msgs/action/Fibonacci"

[[action_client]]
name = "/climb"
type = "test_msgs/action/Fibonacci"

[[parameter]]
name = "gain"
type = "double"
default = 1.5
unit = "1/s"
range = [0.0, 10.0]
"""

SCENARIOS = """\
import numpy
from grader.scenario import *

class Tank:
    def __init__(self, level):
        self.reads, self.publishes, self.level = {}, {"/in": "std_msgs/msg/Float64"}, level

    def hear(self, topic, message): ...

    def step(self, seconds):
        self.level -= seconds

    def state(self):
        return {"/in": {"data": self.level}}


def answer(request):
    return {"success": True}


def scenarios(seed):
    return (
        Scenario(
            "first",
            "everything",
            (
                STEP,
                at(1.0).send_goal("/count", order=3),
                at(2.0).cancel(1),
            ),
            duration=3.0,
            MORE
        ),
    )


class ListAsTruth:
    reads, publishes = {}, {}

    def step(self, seconds): ...

    def state(self):
        return {}

    def truth(self):
        return [0.98]
"""

STEP_LINE = 27


def exercise_in(folder: Path, step: str = "", more: str = "", toml: str = TOML) -> Path:
    """Return an exercise whose only scenario has this step and these arguments."""
    exercise = folder / "exercises" / "any_kind"
    exercise.mkdir(parents=True)
    (exercise / "exercise.toml").write_text(toml)
    (exercise / "task.md").write_text("# Any kind\n")
    text = SCENARIOS.replace("STEP", step or "()").replace("MORE", more)
    (exercise / "scenarios.py").write_text(text)
    return exercise


def scenario_of(folder: Path, step: str = "", more: str = "") -> Scenario:
    return declared(load(exercise_in(folder, step, more)), 1)[0]


@pytest.mark.parametrize(
    ("step", "message"),
    [
        ('at(0.5).publish("/in", data=1)', r"/in: 1 \(int\) is given for data, which is double.*1\.0"),
        ('at(0.5).publish("/in", value=1.0)', "has no field 'value'.*Its fields: data"),
        ('at(0.5).publish("/in", data="1.0")', "which is double"),
        ('at(0.5).publish("/nowhere", data=1.0)', r"type of /nowhere is not known.*\[\[subscribe\]\]"),
        ('at(0.5).publish("/in", "std_msgs/msg/Float65", data=1.0)', "there is no type std_msgs/msg/Float65"),
        ('at(0.5).publish("/in", "std_srvs/srv/SetBool", data=True)', "is the type of a service, but /in needs"),
        ('at(0.5).publish("/in", "Float64", data=1.0)', "'Float64' is not the name of a message type"),
        ('at(0.5).publish("/joints", name=["a", 2])', r"name\[1\]"),
        ('at(0.5).publish("/joints", header={"stamp": {"sec": 0.5}})', r"header\.stamp\.sec, which is int32"),
        ('at(0.5).publish("/joints", header={"stamp": {"sec": 2**31}})', "from -2147483648 to 2147483647"),
        ('at(0.5).call("/switch", data=1)', "which is boolean"),
        ('at(0.5).call("/lamp", data=True)', r"type of /lamp is not known.*\[\[service\]\]"),
        ('at(0.5).send_goal("/count", order=1.5)', "order, which is int32"),
        ("at(0.5).cancel(1)", "goal 1 is cancelled, but 0 goals have been sent"),
        ('at(0.5).cancel_all("/climb")', "there is no action /climb"),
        ('at(0.5).kill("talker.py")', "there is no program 'talker.py'"),
        ('at(0.5).leave("/moon")', "nothing here is called '/moon'"),
        ('at(0.5).transition("start")', "there is no transition 'start'"),
        ("Message(0, '/in', 'std_msgs/msg/Float64', {'data': None})", "which is double"),
        ('at("0.5").publish("/in", data=1.0)', r"at\('0.5'\): give seconds after the start"),
        ('at(-1.0).publish("/in", data=1.0)', r"at\(-1.0\): give seconds after the start"),
        ('at(0.5).publish("/joints", position=numpy.zeros((2, 3)))', r"shape \(2, 3\) is given for position.*ravel"),
        ('at(6.05).publish("/in", data=1.0)', "6.05 s after the start, but the scenario first ends after 3 s"),
    ],
)
def test_a_step_that_can_not_be_is_reported_with_its_line(tmp_path: Path, step: str, message: str) -> None:
    with pytest.raises(ExerciseError) as caught:
        scenario_of(tmp_path, step)
    assert (caught.value.problem.file.name, caught.value.problem.line) == ("scenarios.py", STEP_LINE)
    assert re.search(message, f"{caught.value.problem.problem} {caught.value.problem.fix}"), str(caught.value)


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ('servers=Server("/lamp", replies=reply(success=1))', "success, which is boolean"),
        ('servers=Server("/lamp", replies=lambda request: {})', "lambda.*not a function"),
        ('servers=ActionServer("/climb", goals=succeeds(result={"sequence": [1.5]}))', r"sequence\[0\]"),
        ('servers=ActionServer("/climb", goals=aborts(feedback={0.5: {"sum": 1}}))', "has no field 'sum'"),
        ('servers=ActionServer("/climb")', "no script for a goal"),
        ('world=World(Tank, level="full")', "the world Tank fails: TypeError"),
        ("world=World(Tank, level=1)", ""),
        ("world=World(Tank)", "the world Tank fails"),
        ('companions=Companion("nobody.py")', "there is no file nobody.py"),
        ("rate=-1", "rate=-1"),
        ("rate=0", "rate=0.*leave it out"),
        ("remapings={}", "unexpected keyword argument 'remapings'.*Did you mean remappings"),
        ("world=World(Tank(1.0))", r"World\(Tank\(…\)\): give the class itself"),
        ("world=World(Tank, level=1.0, period=0)", "the world's period=0"),
        ("world=World(ListAsTruth)", r"ListAsTruth.truth\(\) returns \[0.98\].*Return a dictionary"),
        ("namespace='/le ft'", "namespace='/le ft'"),
        ('servers=Server("/lamp", replies=reply(), gone=9.0)', "gone of /lamp comes 9 s after the start, but .* ends"),
        ("parameters={'gain': None}", "the parameter gain is NoneType"),
    ],
)
def test_so_is_what_is_wrong_with_a_peer(tmp_path: Path, more: str, message: str) -> None:
    if not message:
        assert scenario_of(tmp_path, more=more)
        return
    with pytest.raises(ExerciseError) as caught:
        scenario_of(tmp_path, more=more)
    assert caught.value.problem.line
    assert re.search(message, f"{caught.value.problem.problem} {caught.value.problem.fix}"), str(caught.value)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("range = [0.0, 10.0]", "range = [10.0, 0.0]", "Give the lowest and the highest value"),
        ("range = [0.0, 10.0]", 'range = ["low", 10.0]', "Give the lowest and the highest value"),
        ('"/in"', '"/ín"', "in letters, digits and _"),
        (
            "[[parameter]]",
            '[[parameter]]\nname = "gain"\ntype = "double"\n\n[[parameter]]',
            "there are two .*for 'gain'",
        ),
    ],
)
def test_so_is_what_is_wrong_with_a_declaration(tmp_path: Path, old: str, new: str, message: str) -> None:
    with pytest.raises(ExerciseError) as caught:
        load(exercise_in(tmp_path, toml=TOML.replace(old, new)))
    assert caught.value.problem.line
    assert re.search(message, f"{caught.value.problem.problem} {caught.value.problem.fix}"), str(caught.value)


def test_one_name_for_two_scenarios_is_reported_with_the_line_of_the_second(tmp_path: Path) -> None:
    folder = exercise_in(tmp_path)
    with (folder / "scenarios.py").open("a") as file:
        file.write("\n\nfirst = scenarios\n\n\ndef scenarios(seed):\n    return (*first(seed), *first(seed))\n")
    with pytest.raises(ExerciseError, match="'first': twice"):
        declared(load(folder), 1)


EVERYTHING = """parameters={"gain": 2.0, "names": ["a", "b"]}, qos={"/in": Qos(reliability="best_effort")},
            servers=(Server("/lamp", replies=(reply(success=True), reply(0.5, success=False), no_reply()), appears=1.0),
                     ActionServer("/climb", goals=succeeds(1.0, {"sequence": [1]}, {0.5: {"sequence": []}}))),
            world=World(Turtle, x=1.0, pose="geometry_msgs/msg/Pose2D"),
            remappings={"/in": "/other"}, arguments=("a",)"""

STEPS = """(at(0.5).publish("/joints", name=["a"], position=[1.0]), at(0.1).set_parameter("gain", [1.0]),
                 at(0.2).subscribe("/joints", name="late"), at(0.3).call("/switch", data=True))"""


def test_a_students_copy_has_the_same_scenarios(tmp_path: Path) -> None:
    scenario = scenario_of(tmp_path, STEPS, EVERYTHING)
    again = from_plain(plain(scenario), tmp_path)
    assert again == scenario
    assert again.digest == scenario.digest


def test_code_of_scenarios_py_is_not_in_a_students_copy(tmp_path: Path) -> None:
    with pytest.raises(NotForStudents, match="Tank"):
        plain(scenario_of(tmp_path, more="world=World(Tank, level=1.0)"))


def test_a_world_in_a_file_of_its_own_is_in_a_students_copy_of_that_folder(tmp_path: Path) -> None:
    author, student = exercise_in(tmp_path / "author", more="world=World(Tank, level=1.0)"), tmp_path / "student"
    text = (author / "scenarios.py").read_text()
    (author / "tank.py").write_text(text[text.index("class Tank") : text.index("def answer")])
    (author / "scenarios.py").write_text(f"{text.replace('class Tank', 'class Other')}\n\nfrom tank import Tank\n")
    (scenario,) = declared(load(author), seed=0)
    kept = plain(scenario)
    assert str(tmp_path) not in repr(kept)
    with pytest.raises(OSError, match=r"tank\.py"):
        from_plain(kept, student)
    student.mkdir()
    (student / "tank.py").write_bytes((author / "tank.py").read_bytes())
    world = from_plain(kept, student).world
    assert world.begin().state() == {"/in": {"data": 1.0}}


def test_an_error_in_a_world_or_a_module_names_its_line_there(tmp_path: Path) -> None:
    author = exercise_in(tmp_path, more="world=World(tank.Tank)")
    (author / "scenarios.py").write_text(f"import tank\n{(author / 'scenarios.py').read_text()}")
    for text, line, message in (
        ("import json\njson[0]\n", 2, "TypeError"),
        ("class Tank:\n reads = {}[1]", 2, "KeyError: 1"),
        ("class Tank:\n reads = publishes = {}\n step = print\n def state(self):\n  return {'/in': {}}", None, "'/in'"),
        ("class Tank:\n def __init__(self):\n  {}['x']\n", 3, "world Tank fails: KeyError: 'x'"),
    ):
        (author / "tank.py").write_text(text)
        with pytest.raises(ExerciseError, match=message) as caught:
            declared(load(author), seed=0)
        problem = caught.value.problem
        assert line is None or (problem.file.name, problem.line) == ("tank.py", line)


def test_numbers_of_numpy_are_numbers(tmp_path: Path) -> None:
    step = 'at(0.5).publish("/in", data=numpy.float32(0.5)), at(0.6).send_goal("/count", order=numpy.int64(3))'
    assert [vars(one)["fields"] for one in scenario_of(tmp_path, step).content[:2]] == [{"data": 0.5}, {"order": 3}]


@pytest.mark.parametrize(
    ("imported", "message"),
    [
        ("from grader.scenario import wave", "Write: from grader.scenario.numbers import wave"),
        ("from grader.scenario import Sever", "Write: from grader.scenario import Server"),
        ("from grader.scenario import numbers\nnumbers('/in', [])", "from grader.scenario.numbers import numbers"),
        ("while True: pass", "it computed for 0.05 s: is there an endless loop"),
    ],
)
def test_what_ends_scenarios_py_at_its_top_is_reported_with_its_line_and_what_to_do(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, imported: str, message: str
) -> None:
    monkeypatch.setattr("grader.exercise.computing_limit.LONGEST_CPU_S", 0.05)
    author = exercise_in(tmp_path)
    (author / "scenarios.py").write_text(f"{imported}\n{(author / 'scenarios.py').read_text()}")
    with pytest.raises(ExerciseError) as caught:
        declared(load(author), seed=0)
    problem = caught.value.problem
    assert (problem.file.name, problem.line) == ("scenarios.py", imported.count("\n") + 1)
    assert message in f"{problem.problem} {problem.fix}"


def test_two_exercises_may_have_worlds_in_files_of_the_same_name(tmp_path: Path) -> None:
    levels = []
    for number in (1.0, 2.0):
        author = exercise_in(tmp_path / str(number), more="world=World(tank.Tank)")
        world = "class Tank:\n    reads = publishes = {}\n    step = hear = print\n    state = dict\n    level = "
        (author / "tank.py").write_text(f"{world}{number}\n")
        text = (author / "scenarios.py").read_text()
        (author / "scenarios.py").write_text(f"import tank\n{text}")
        (scenario,) = declared(load(author), seed=0)
        assert scenario.world
        levels.append(scenario.world.begin().level)  # type: ignore[attr-defined]
    assert levels == [1.0, 2.0]


def test_scenarios_differ_if_anything_in_them_does(tmp_path: Path) -> None:
    digests = {
        scenario_of(tmp_path / str(number), step, more).digest
        for number, (step, more) in enumerate(
            [
                ("", ""),
                ("", "rate=50.0"),
                ("", "parameters={'gain': 1.0}"),
                ("", "servers=Server('/lamp')"),
                ("", "servers=Server('/lamp', replies=no_reply())"),
                ("", "world=World(Tank, level=1.0)"),
                ("", "world=World(Tank, level=2.0)"),
                ("at(0.5).call('/switch', data=True)", ""),
                ("at(0.6).call('/switch', data=True)", ""),
            ]
        )
    }
    assert len(digests) == 9


def test_a_worlds_arguments_may_have_any_keys() -> None:
    world = AuthorCode("grader.scenario.models", "GoalPoint")
    digests = {Scenario("", "", world=World(world, walls={(0, 1): number, 3: 4})).digest for number in (1, 2)}
    assert len(digests) == 2


def test_packages_are_pinned_to_what_is_installed(tmp_path: Path) -> None:
    exercise = load(exercise_in(tmp_path, toml=TOML.replace("points = 10", "points = 10\npackages = ['PyYAML']")))
    assert exercise.packages == (f"PyYAML=={metadata.version('PyYAML')}",)
    assert f'packages = ["PyYAML=={metadata.version("PyYAML")}"]' in to_toml(exercise)
    ending = Ending("did-not-start", "ModuleNotFoundError: No module named 'cv2'")
    assert message_of(ending, exercise).endswith(f", numpy, {exercise.packages[0]}.")
    for module, advice in (
        ("rospy", "ROS 1. The course uses ROS 2, where it is rclpy,"),
        ("std_srv.srv", ""),
    ):
        ending = Ending("did-not-start", f"ModuleNotFoundError: No module named '{module}'")
        assert (advice or "Is it a misspelling of std_srvs?") in message_of(ending, exercise)


def test_an_interface_is_written_as_it_was_read(tmp_path: Path) -> None:
    exercise = load(exercise_in(tmp_path))
    assert to_toml(exercise) == TOML
    assert (exercise.of_role("service")[0].name, exercise.of_role("client")[0].name) == ("/switch", "/lamp")
    assert (exercise.of_role("action")[0].name, exercise.of_role("action_client")[0].name) == ("/count", "/climb")


@pytest.mark.parametrize(
    ("old", "new", "line", "message"),
    [
        ("points = 10", "points = 10\nclas = 'A'", 3, "'clas' is not known"),
        ('title = "Any kind"\n', "", None, "title is missing"),
        (
            'file = "any_kind.py"\nnode = "any_kind"\nreference_node = "world"\n',
            "[[program]]\nfile = 'a.py'\nnode = 'a'\n",
            None,
            "file is missing.*a submission that is one file with all programs",
        ),
        ("depth = 5", "deph = 5", 14, r"'deph' is not known in \[\[publish\]\].*depth"),
        ("depth = 5", "depth = '5'", 14, "depth = '5'"),
        ('"best_effort"', '"best-effort"', 15, "reliable, best_effort"),
        ('type = "std_srvs/srv/SetBool"\n\n', 'type = "std_srvs/msg/SetBool"\n\n', 22, "Write a type as"),
        ('name = "/lamp"', 'name = "lamp"', 25, "full name of the service"),
        ("default = 1.5", "default = 1", 40, "default = 1, but the parameter gain is of type double"),
        ('type = "double"', 'type = "float"', 39, "double"),
        ('name = "/count"\n', "", 29, r"no name in \[\[action\]\]"),
        ("elements = { called", "elements = { calld", 18, "elements ="),
        (
            "points = 10",
            "points = 10\npackages = ['no-such-package']",
            3,
            "no-such-package.*is not installed here.*pip install",
        ),
        (
            "points = 10",
            "points = 10\npackages = ['numpy==0.1']",
            3,
            r"numpy is installed in version .* not as numpy==0\.1",
        ),
        ("points = 10", "points = 10\npackages = ['numpy>=1']", 3, "'numpy>=1'.*Write a name on PyPI"),
    ],
)
def test_what_is_wrong_in_exercise_toml_is_reported_with_its_line(
    tmp_path: Path, old: str, new: str, line: int | None, message: str
) -> None:
    assert old in TOML
    with pytest.raises(ExerciseError) as caught:
        load(exercise_in(tmp_path, toml=TOML.replace(old, new, 1)))
    assert (caught.value.problem.file.name, caught.value.problem.line) == ("exercise.toml", line), str(caught.value)
    assert re.search(message, f"{caught.value.problem.problem} {caught.value.problem.fix}"), str(caught.value)
