"""A launch file is handed in, alone or with the packages that it starts, and the grader starts what it describes."""

from __future__ import annotations

import io
import zipfile
from dataclasses import replace
from pathlib import Path

import pytest

from grader.checking.proofreader import problems_of
from grader.exercise import Exercise, load
from grader.grading import Options, grading_of
from grader.runner.program_end import survived_by
from grader.submission.code import Code, code_of
from grader.submission.launch_files import launched
from grader.submission.problems import AmbiguousProgram, Unreadable
from grader.submission.reader import of_content
from grader.workers import WorkerPool
from spinbook.new.templates import BY_NAME, write_exercise

SETUP = "setup(name='arms', entry_points={'console_scripts': ['arm = arms.arm:main']})"
PACKAGE = {"package.xml": "<name>arms</name>", "setup.py": SETUP, "arms/arm.py": "import rclpy\ndef main(): ...\n"}
LAUNCH = "def generate_launch_description(): ...\n"


@pytest.fixture(scope="module")
def exercise(tmp_path_factory: pytest.TempPathFactory) -> Exercise:
    """An exercise of the kind launch-file, with the package `sensors` in data/."""
    folder = tmp_path_factory.mktemp("course")
    write_exercise(folder, "grip", "Grip", BY_NAME["launch-file"])
    return load(folder / "exercises" / "grip")


def zipped(files: dict[str, str]) -> bytes:
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as archive:
        for name, text in files.items():
            archive.writestr(name, text)
    return content.getvalue()


def start_of(code: Code) -> str:
    return code.files[code.main].decode()


@pytest.mark.parametrize(
    ("files", "launched"),
    [
        ({"launch/grip_launch.py": LAUNCH}, "launch/grip_launch.py"),
        ({"launch/grip.launch.xml": "<launch/>", "launch/other_launch.py": LAUNCH}, "launch/grip.launch.xml"),
        (
            {"launch/all.launch.py": LAUNCH + "# part.launch.py", "launch/part.launch.py": LAUNCH},
            "launch/all.launch.py",
        ),
    ],
    ids=["by its name", "in XML", "the one that includes the other"],
)
def test_the_launch_file_of_a_package_is_started_with_its_executables(
    files: dict[str, str], launched: str, exercise: Exercise
) -> None:
    files = {f"arms/{name}": text for name, text in {**PACKAGE, **files}.items()}
    start = start_of(code_of("p.zip", zipped(files), exercise))
    assert f"launch_unbuilt('arms/{launched}'" in start
    assert "'arm': UnbuiltExecutable('arms/arms/arm.py', 'arms', 'arms.arm', 'main')" in start
    assert "'gauge': UnbuiltExecutable('data/sensors/gauge.py', 'data/sensors')" in start


def test_one_file_may_hold_the_launch_file_and_programs(exercise: Exercise) -> None:
    text = f"# file: grip_launch.py\n{LAUNCH}# file: arm.py\nimport rclpy\n"
    start = start_of(code_of("mine.py", text.encode(), exercise))
    assert "'grip': UnbuiltPackage('', {'arm': UnbuiltExecutable('arm.py', '')})" in start


XML = '<?xml version="1.0"?>\n<!-- mine -->\n<launch>\n<node pkg="sensors" exec="gauge"/></launch>\n'
YAML = "# mine\nlaunch:\n- node:\n    pkg: sensors\n    exec: gauge\n"


@pytest.mark.parametrize(
    ("name", "text", "launched"),
    [
        ("grip.launch.xml", XML, "grip.launch.xml"),
        ("mine_launch.yaml", YAML, "grip.launch.yaml"),
        ("grip.launch (1).xml", XML, "grip.launch.xml"),
        ("grip.xml", "\ufeff" + XML, "grip.launch.xml"),
        ("grip.txt", YAML, "grip.launch.yaml"),
        ("grip.launch", XML, "grip.launch.xml"),
    ],
)
def test_a_lone_launch_file_may_be_xml_or_yaml(name: str, text: str, launched: str, exercise: Exercise) -> None:
    code = code_of(name, text.encode(), exercise)
    assert f"launch_unbuilt('{launched}'" in start_of(code)
    assert code.source == text.removeprefix("\ufeff")
    other = replace(exercise, nodes=())
    with pytest.raises(Unreadable, match="neither Python"):
        code_of(name, text.encode(), other)


@pytest.mark.parametrize(
    ("files", "error"),
    [
        (PACKAGE, Unreadable),
        ({"a.launch.py": LAUNCH, "b.launch.py": "# another\n"}, AmbiguousProgram),
    ],
    ids=["none", "two"],
)
def test_without_a_clear_launch_file_nothing_is_guessed(
    files: dict[str, str], error: type[Exception], exercise: Exercise
) -> None:
    with pytest.raises(error, match="launch file"):
        code_of("p.zip", zipped(files), exercise)


def test_what_it_describes_runs_in_simulated_time(exercise: Exercise, workers: WorkerPool) -> None:
    grading = grading_of(exercise, Options(), workers)
    recording = grading.references["scaled"]
    assert recording.nodes == ("/grip/left", "/grip/right")
    readings = [message.fields["data"] for message in recording.received if message.topic == "/grip/right_reading"]
    assert readings[:3] == [0.0, 3.0, 6.0]
    broken = of_content("mine.py", b"from launch import Description\n", exercise)
    assert "grip_launch.py:1: `Description` of launch is not supported here" in grading.grade(broken).message


def test_a_program_of_a_launch_that_dies_is_named() -> None:
    log = (
        "[INFO] [arm-1]: process started with pid [5]\n[arm-1] Traceback (most recent call last):\n"
        '[arm-1]   File "/submission/arm.py", line 2, in <module>\n[arm-1]     1 / 0\n'
        "[arm-1] ZeroDivisionError: division by zero\n[ERROR] [arm-1]: process has died [pid 5, exit code 1]\n"
    )
    assert survived_by(log, {"arm.py": "a\n1 / 0\n"}).endswith(
        "ZeroDivisionError: division by zero in line 2: `1 / 0`."
    )
    assert survived_by(log, {}).endswith("ended with an error: arm-1. ZeroDivisionError: division by zero")


@pytest.mark.parametrize(
    ("file", "old", "new", "problem"),
    [
        ("exercise.toml", "grip_launch.py", "grip.py", "file = 'grip.py'"),
        ("exercise.toml", '"/grip/left"', '"left"', "nodes = "),
        ("exercise.toml", "points = 20", 'points = 20\nnode = "grip"', "nodes is given next to node"),
        ("exercise.toml", "grip_launch.py", "checks.py", "checks.py is a file of the exercise itself"),
        ("scenarios.py", "rate=20.0)", 'rate=20.0, namespace="/a")', "namespace is given, but"),
    ],
)  # fmt: skip
def test_what_does_not_go_with_a_launch_file_is_an_authors_error(
    file: str, old: str, new: str, problem: str, tmp_path: Path
) -> None:
    write_exercise(tmp_path, "grip", "Grip", BY_NAME["launch-file"])
    path = tmp_path / "exercises" / "grip" / file
    path.write_text(path.read_text(encoding="utf-8").replace(old, new), encoding="utf-8")
    (first, *_) = problems_of(path.parent)
    assert problem in first.problem
    assert first.line


def test_what_is_set_for_a_node_stands_in_its_own_element_in_a_file_of_any_length() -> None:
    text = '<node exec="beat"></node><node exec="beat"><remap from="a" to="b"/>' + "<node>" * 150_000
    nodes = launched({"a.launch.xml": text.encode()})
    assert [(node.executable, node.settings) for node in nodes] == [("beat", ()), ("beat", ("remappings",))]
