"""The engine knows no exercise: names, labels and advice come from exercise.toml."""

from __future__ import annotations

import ast
import re
import shutil
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from grader.checking.ending_message import message_of
from grader.exercise import ExerciseError, load
from grader.exercise.writing import to_toml
from grader.recording import Ending

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).parents[2]

#: What an exercise's author may use, and what only makes sense for one ROS 2 package. Templates are exercises.
ABOUT_ROS_MESSAGES = (
    "grader/scenario/joint_states.py",
    "grader/scenario/models.py",
    "grader/scenario/physics.py",
    "spinbook/kernel/plot/quantity.py",
    "spinbook/new/",
)

#: Names that ROS 2 itself has, the topics on which `%robot` listens, and the world and messages of `grader.scenario`.
OF_ROS = re.compile(
    r"JointState|JointChain|(linear|angular)_velocity|turtlesim|robot_description|RobotDescription|/joint_(states|commands)"
    r"|^grader\.scenario\.joint_states$"
)

#: Files of a page that come from elsewhere, or draw any robot.
OTHERS = ("codemirror.js", "robot.js")


def engine_files() -> list[Path]:
    files = [file for package in ("grader", "spinbook") for file in sorted((ROOT / package).rglob("*.py"))]
    return [file for file in files if not str(file.relative_to(ROOT)).startswith(ABOUT_ROS_MESSAGES)]


def words_of_exercises() -> re.Pattern[str]:
    names = {"joint", "velocity", "velocities"}
    for file in sorted((ROOT / "exercises").glob("*/exercise.toml")):
        exercise = tomllib.loads(file.read_text(encoding="utf-8"))
        names |= {file.parent.name, *(exercise.get(key, "") for key in ("class", "file", "node", "reference_node"))}
        topics = (*exercise.get("subscribe", ()), *exercise.get("publish", ()))
        names |= {topic["elements"]["called"] for topic in topics if "elements" in topic}
    names -= {"", "turtlesim", "robot_description"}
    # "disjoint" is a word of its own.
    return re.compile(f"(?<!dis)({'|'.join(sorted(map(re.escape, names)))})", re.IGNORECASE)


def texts(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """Yield every identifier and every string of a module with its line, but no docstring and no text of `--help`."""
    docstrings = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    docstrings |= {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.keyword) and node.arg == "help"}
    for node in ast.walk(tree):
        for name in ("id", "arg", "attr", "name", "asname"):
            if isinstance(text := getattr(node, name, None), str):
                yield getattr(node, "lineno", 0), text
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in docstrings:
            yield node.lineno, node.value


def test_the_engine_has_no_word_of_an_exercise() -> None:
    words = words_of_exercises()
    hits = [
        f"{file.relative_to(ROOT)}:{line}: {text[:80]}"
        for file in engine_files()
        for line, text in texts(ast.parse(file.read_text(encoding="utf-8")))
        if words.search(OF_ROS.sub("", text))
    ]

    assert not hits, "labels and advice belong into exercise.toml:\n" + "\n".join(hits)


def test_templates_of_pages_have_no_word_of_an_exercise() -> None:
    words = words_of_exercises()
    pages = [
        file
        for package in ("grader", "spinbook")
        for ending in ("j2", "html", "css", "js")
        for file in sorted((ROOT / package).rglob(f"*.{ending}"))
        if "/new/" not in str(file) and file.name not in OTHERS
    ]
    assert pages

    assert [file.name for file in pages if words.search(OF_ROS.sub("", file.read_text(encoding="utf-8")))] == []


@pytest.mark.parametrize("text", ["joint_velocity", "JointVelocity", "one joint", "heartbeat.py", "joint_commands"])
def test_a_word_of_an_exercise_is_recognized(text: str) -> None:
    assert words_of_exercises().search(text)


@pytest.mark.parametrize("text", ["sensor_msgs/msg/JointState", "angular_velocity"])
def test_a_name_of_ros_is_no_word_of_an_exercise(text: str) -> None:
    assert not words_of_exercises().search(OF_ROS.sub("", text))


def test_advice_on_an_exception_comes_from_exercise_toml() -> None:
    exercise = load(ROOT / "exercises" / "joint_velocity")
    message = "Your program ended by itself: KeyError: 'left_elbow' in line 12."

    shown = message_of(Ending("crashed", message), exercise)

    assert shown == f"{message} What if a joint is in this message and was not in the one before?"
    assert "joint" not in message_of(Ending("crashed", message), replace(exercise, advice={}))


def test_an_error_with_advice_of_its_own_gets_no_more() -> None:
    exercise = load(ROOT / "exercises" / "joint_velocity")
    error = "Your program ended: IndexError: list assignment index out of range in line 12 of code cell 3: `a[0] = `b`."

    assert message_of(Ending("crashed", error), exercise) == f"{error} {exercise.advice['IndexError']}"
    for advised in (f"{error} The list is shorter.", error.replace("Index", "Name") + " Its own."):
        assert message_of(Ending("crashed", advised), exercise) == advised


def test_a_name_with_the_wrong_capital_letters_is_told_from_one_that_is_misspelt() -> None:
    exercise = load(ROOT / "exercises" / "heartbeat")
    message = "ImportError: cannot import name '{}' from 'std_msgs.msg'"
    module, misspelt = (message_of(Ending("crashed", message.format(n)), exercise) for n in ("header", "Haeder"))
    assert module.endswith("has no header. It may have Header: capital letters count.")
    assert misspelt.endswith("has no Haeder. Is the name spelled right?")
    of_rclpy = message_of(Ending("crashed", "ImportError: cannot import name 'Node' from 'rclpy'"), exercise)
    assert of_rclpy.endswith("Node is in rclpy.node: write from rclpy.node import Node.")


@pytest.mark.parametrize(
    ("module", "right"),
    [
        ("std_msgs.srv", "std_srvs.srv import SetBool"),
        ("std_msgs.messages", "std_msgs.msg import Bool"),
        ("std_srvs.msg' in line 4: `from std_srvs.msg import SetBool`.", "std_srvs.srv import SetBool"),
        ("SetBool", "std_srvs.srv import SetBool"),
    ],
)
def test_an_import_from_the_wrong_package_of_interfaces_comes_with_the_right_one(module: str, right: str) -> None:
    message = f"ModuleNotFoundError: No module named '{module}'"
    shown = message_of(Ending("did-not-start", message), load(ROOT / "exercises" / "motor_switch"))
    assert shown.endswith(f": write from {right}.")


@pytest.mark.parametrize(
    ("error", "advice"),
    [
        ("NameError: name 'Header' is not defined", "imported or defined before this line?"),
        ("SyntaxError: invalid character '‘' (U+2018)", "copied text may have other quotes, dashes or spaces"),
        ("SyntaxError: invalid syntax", "Look at the end of the line before it, too."),
        ("SyntaxError: 'return' outside function", "Indent this line as the other lines of its function"),
        ("SyntaxError: 'await' outside async function", "begins with async def"),
        ('SyntaxError: invalid syntax. Perhaps you forgot a comma? in line 3: `x("<a b="c">")`', "write it as '…'"),
        ("TypeError: unsupported operand type(s) for -: 'float' and 'NoneType'", "Something in this line is None"),
        ("SyntaxError: invalid non-printable character U+00A0", "Type this character again"),
    ],
)
def test_what_a_beginner_can_do_about_an_error_is_said(error: str, advice: str) -> None:
    message = f"Your program did not start: {error} in line 3."
    assert advice in message_of(Ending("did-not-start", message), load(ROOT / "exercises" / "heartbeat"))


def test_advice_that_is_no_text_is_refused_with_its_line(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "exercises" / "joint_velocity", tmp_path / "joint_velocity")
    file = tmp_path / "joint_velocity" / "exercise.toml"
    lines = re.sub(r"KeyError = .*", "KeyError = 3", file.read_text(encoding="utf-8"))
    file.write_text(lines, encoding="utf-8")

    with pytest.raises(ExerciseError) as error:
        load(file.parent)

    assert error.value.problem.line == lines.splitlines().index("[advice]") + 1
    assert "Give a table of texts, such as advice = { KeyError = " in str(error.value)


def test_a_students_copy_of_exercise_toml_keeps_the_advice(tmp_path: Path) -> None:
    exercise = load(ROOT / "exercises" / "joint_velocity")
    copy = tmp_path / "joint_velocity"
    copy.mkdir()
    (copy / "exercise.toml").write_text(to_toml(exercise), encoding="utf-8")
    (copy / "task.md").write_text(exercise.task, encoding="utf-8")

    assert load(copy).advice == exercise.advice
