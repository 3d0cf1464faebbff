"""ROS 2 packages and workspaces are read as students zip them: the program is found, and brings its modules along."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from student_work import IMPORTS, NODE, OLD, PROGRAM, check_cell, notebook, tarred, written, zipped

from grader.exercise import Exercise
from grader.gradescope import run as gradescope
from grader.grading.grading import Grading
from grader.submission import read
from grader.submission.code import code_of, uses_other_files
from grader.submission.program_choice import digest_of
from grader.submission.reader import is_one, of_content
from grader.submission.submission import Submission

SETUP = """\
from setuptools import setup
package_name = 'my_robot'
setup(
    name=package_name,
    packages=[package_name],
    data_files=[('share/' + package_name, ['package.xml'])],
    entry_points={
        'console_scripts': [
            'beat = my_robot.beat_node:main',
            'other = my_robot.other:main',
        ],
    },
)
"""
MANIFEST = "<package format='3'><name>my_robot</name></package>\n"
RATES = "RATE = 0.25\n"
IN_PACKAGE = PROGRAM.replace(IMPORTS, f"{IMPORTS}from my_robot.rates import RATE\n").replace("0.25", "RATE")
OTHER = "import rclpy\nfrom rclpy.node import Node\n\ndef main():\n    rclpy.init()\n    rclpy.spin(Node('other'))\n"

PACKAGE = {
    "package.xml": MANIFEST,
    "setup.py": SETUP,
    "setup.cfg": "[develop]\nscript_dir=$base/lib/my_robot\n",
    "resource/my_robot": "",
    "my_robot/__init__.py": "",
    "my_robot/beat_node.py": IN_PACKAGE,
    "my_robot/rates.py": RATES,
    "my_robot/other.py": OTHER,
    "launch/robot.launch.py": "from launch_ros.actions import Node\nNode(package='my_robot', executable='beat')\n",
    "test/test_flake8.py": "def test(): pass\n",
}


def inside(folder: str, files: dict[str, str] | None = None) -> dict[str, str | bytes]:
    return {f"{folder}/{name}": content for name, content in (files or PACKAGE).items()}


#: What colcon, git, Python, editors and operating systems leave beside it.
LEFT_BEHIND: dict[str, str | bytes] = {
    "ws/build/my_robot/build/lib/my_robot/beat_node.py": OLD,
    "ws/install/my_robot/lib/python3.12/site-packages/my_robot/beat_node.py": OLD,
    "ws/install/my_robot/lib/my_robot/beat": "#!/usr/bin/python3\n",
    "ws/log/latest_build/events.log": "x\n",
    "ws/.git/HEAD": "ref: x\n",
    "ws/src/my_robot/my_robot/__pycache__/beat_node.cpython-312.pyc": b"\0\0",
    "ws/src/.DS_Store": b"\0",
    "ws/src/my_robot/.vscode/settings.json": "{}",
    "ws/.venv/lib/python3.12/site-packages/x.py": "x = 1\n",
    "ws/ros_env/pyvenv.cfg": "home = /usr\n",
    "ws/ros_env/bin/activate_this.py": OLD,
    "__MACOSX/ws/src/my_robot/my_robot/._beat_node.py": b"\0\5\26\7",
}
#: The same package in an earlier state.
OLDER = {name: content.replace("self.beat)", "self.beat, None)") for name, content in PACKAGE.items()}
NO_ENTRIES = {name: content for name, content in PACKAGE.items() if name != "setup.py"}
UPLOADS = {
    "a package": ("beat.zip", zipped(inside("my_robot"))),
    "the package's content": ("beat.zip", zipped(PACKAGE)),
    "a workspace with what was built": ("ws.zip", zipped({**inside("ws/src/my_robot"), **LEFT_BEHIND})),
    "a zip in a zip": ("all.zip", zipped({"homework/beat.zip": zipped(inside("my_robot"))})),
    "a zip in a tar": ("all.tar.gz", tarred({"beat.zip": zipped(PACKAGE)})),
    "a tar": ("beat.tar.gz", tarred(inside("my_robot"))),
    "a tar of another kind": ("BEAT.TAR.XZ", tarred(inside("my_robot"), "xz")),
    "without entry points": ("beat.zip", zipped(inside("my_robot", NO_ENTRIES))),
    "the inner folder alone": (
        "beat.zip",
        zipped({f"my_robot/{name}.py": PACKAGE[f"my_robot/{name}.py"] for name in ("__init__", "beat_node", "rates")}),
    ),
    "the inner folder's content": (
        "beat.zip",
        zipped({f"{name}.py": PACKAGE[f"my_robot/{name}.py"] for name in ("__init__", "beat_node", "rates")}),
    ),
    "relative imports": (
        "beat.zip",
        zipped({**inside("p"), "p/my_robot/beat_node.py": IN_PACKAGE.replace("from my_robot.rates", "from .rates")}),
    ),
    "modules of another package": (
        "ws.zip",
        zipped(
            {
                **inside("src/my_robot"),
                "src/my_robot/my_robot/beat_node.py": IN_PACKAGE.replace("from my_robot.rates", "from common.rates"),
                "src/common/package.xml": MANIFEST.replace("my_robot", "common"),
                "src/common/common/__init__.py": "",
                "src/common/common/rates.py": RATES,
            }
        ),
    ),
    "installed by CMake": (
        "beat.zip",
        zipped(
            {
                "p/package.xml": MANIFEST,
                "p/CMakeLists.txt": "install(PROGRAMS\n  scripts/beat.py\n  DESTINATION lib/${PROJECT_NAME})\n",
                "p/my_robot/__init__.py": "",
                "p/my_robot/rates.py": RATES,
                "p/scripts/beat.py": IN_PACKAGE,
                "p/src/main.cpp": "int main() {}\n",
            }
        ),
    ),
    "installed by CMake without a suffix": (
        "beat.zip",
        zipped(
            {
                "p/CMakeLists.txt": "install(PROGRAMS scripts/beat scripts/old.py DESTINATION lib/${PROJECT_NAME})\n",
                "p/scripts/beat": f"#!/usr/bin/env python3\n{IN_PACKAGE.replace('my_robot.rates', 'rates')}",
                "p/scripts/rates.py": RATES,
                "p/scripts/old.py": "print(1)\n",
            }
        ),
    ),
    "what colcon installed, without its source": (
        "install.zip",
        zipped(
            {
                f"install/my_robot/lib/python3.12/site-packages/{name}": content
                for name, content in PACKAGE.items()
                if name.startswith("my_robot/")
            }
        ),
    ),
    "the package that the launch file starts": (
        "ws.zip",
        zipped(
            {
                **inside("src/my_robot"),
                **{
                    name.replace("my_robot", "older"): content
                    for name, content in inside("src/my_robot", OLDER).items()
                },
                "src/my_robot/launch/all.launch.py": "Node(package='my_robot', executable='beat')",
            }
        ),
    ),
    "entry points in setup.cfg": (
        "beat.zip",
        zipped(
            {
                **inside("p", NO_ENTRIES),
                "p/setup.cfg": "[options.entry_points]\nconsole_scripts =\n  beat = my_robot.beat_node:main\n",
            }
        ),
    ),
    "entry points in pyproject.toml": (
        "beat.zip",
        zipped(
            {
                **inside("p/lib", {name: PACKAGE[name] for name in PACKAGE if name.startswith("my_robot/")}),
                "p/pyproject.toml": "[project]\nscripts = {beat = 'my_robot.beat_node:main'} # installed\n",
            }
        ),
    ),
    "an entry point from parts": (
        "beat.zip",
        zipped({**inside("p"), "p/setup.py": SETUP.replace("'beat = my_robot.beat", "f'beat = {package_name}.beat")}),
    ),
    "a program in a folder of tests": (
        "beat.zip",
        zipped({"tests/test_beat.py": IN_PACKAGE.replace("my_robot.rates", "rates"), "tests/rates.py": RATES}),
    ),
    "a program in __init__.py": (
        "beat.zip",
        zipped(
            {
                **inside("p"),
                "p/my_robot/__init__.py": IN_PACKAGE,
                "p/my_robot/beat_node.py": "",
                "p/setup.py": SETUP.replace("my_robot.beat_node", "my_robot"),
            }
        ),
    ),
    "files beside each other": (
        "beat.zip",
        zipped({"beat.py": IN_PACKAGE.replace("my_robot.rates", "rates"), "rates.py": RATES}),
    ),
}


@pytest.mark.parametrize(("name", "content"), UPLOADS.values(), ids=UPLOADS)
def test_the_program_of_an_upload_is_found_with_its_modules(name: str, content: bytes, exercise: Exercise) -> None:
    submission = of_content(name, content, exercise)
    assert submission.program, submission
    assert "self.create_timer(RATE, self.beat)" in submission.source
    assert any(path.endswith("rates.py") for path in submission.program.files)


@pytest.mark.parametrize(
    "name",
    ["a workspace with what was built", "the inner folder's content", "installed by CMake", "a program in __init__.py"],
)
def test_the_program_of_an_upload_runs(name: str, exercise: Exercise, grading: Grading) -> None:
    grade = grading.grade(of_content(*UPLOADS[name], exercise))
    assert grade.full_marks, grade.message


def test_a_folder_is_read_as_the_same_zip(tmp_path: Path, exercise: Exercise) -> None:
    folder = written(tmp_path / "ws", {**inside("ws/src/my_robot"), **LEFT_BEHIND})
    (folder / "ws" / "src" / "link.py").symlink_to("/etc/passwd")
    submission = read(str(folder), exercise)
    upload = of_content(*UPLOADS["a workspace with what was built"], exercise)
    assert submission.program
    assert upload.program
    assert submission.program.files == upload.program.files
    assert submission.notes == upload.notes == ("Taken: ws/src/my_robot/my_robot/beat_node.py, the executable beat.",)


def test_a_folder_is_one_submission_or_a_class(tmp_path: Path, exercise: Exercise, pair: Exercise) -> None:
    workspace = written(tmp_path / "ws", inside("ws/src/my_robot"))
    programs = written(tmp_path / "programs", {"counter.py": "", "doubler.py": ""})
    people = written(tmp_path / "class", {"anna.py": PROGRAM, "bert/heartbeat.py": PROGRAM})
    assert is_one(workspace, exercise)
    assert is_one(programs, pair)
    assert not is_one(people, exercise)


def test_what_gradescope_has_unpacked_is_read_as_a_folder(tmp_path: Path, exercise: Exercise) -> None:
    assert gradescope.submission(written(tmp_path / "one", {"Beat.PY": PROGRAM}), exercise).source == PROGRAM
    of_folder = gradescope.submission(written(tmp_path / "many", inside("ws/src/my_robot")), exercise)
    assert of_folder.program
    assert "my_robot/rates.py" in of_folder.program.files


@pytest.mark.parametrize(
    ("source", "needs"),
    [(PROGRAM, False), (IN_PACKAGE, True), (PROGRAM.replace(IMPORTS, f"{IMPORTS}from . import rates\n"), True)],
)
def test_a_page_takes_a_program_alone_only_if_it_needs_no_other_file(
    source: str, needs: bool, exercise: Exercise
) -> None:
    content = zipped({**inside("p"), "p/my_robot/beat_node.py": source})
    assert uses_other_files(code_of("p.zip", content, exercise)) is needs


def test_a_package_of_a_file_called_as_the_exercise_needs_no_word(exercise: Exercise) -> None:
    files = {**inside("p"), "p/my_robot/heartbeat.py": PROGRAM}
    del files["p/my_robot/beat_node.py"]
    assert of_content("p.zip", zipped(files), exercise).notes == ()


def test_an_error_has_the_file_and_the_line_of_that_file(exercise: Exercise, grading: Grading) -> None:
    broken = {**inside("p"), "p/my_robot/rates.py": "# the rates\n\nRATE = 1 / 0\n"}
    message = grading.grade(of_content("p.zip", zipped(broken), exercise)).message
    assert "ZeroDivisionError: division by zero in line 3 of my_robot/rates.py: `RATE = 1 / 0`" in message
    unreadable = {**inside("p"), "p/my_robot/rates.py": "RATE = 0.25\n\nRATE = = 1\n"}
    message = grading.grade(of_content("p.zip", zipped(unreadable), exercise)).message
    assert "SyntaxError: invalid syntax in line 3 of my_robot/rates.py: `RATE = = 1`" in message


COUNTER = """\
import rclpy
from rclpy.node import Node


class Counter(Node):
    def __init__(self):
        super().__init__('counter')
"""
DOUBLER = COUNTER.replace("Counter", "Doubler").replace("counter", "doubler")


def test_a_module_of_the_package_never_replaces_pythons_own(tmp_path: Path, exercise: Exercise) -> None:
    files = {
        **inside("p"),
        "p/my_robot/beat_node.py": "import logging, rates\n\ndef main():\n    print(logging.INFO, rates.RATE)\n",
        "p/my_robot/logging.py": "INFO = 'mine'\n",
        "p/setup.py": SETUP.replace("'other = my_robot.other:main',", ""),
    }
    program = of_content("p.zip", zipped(files), exercise).program
    assert program
    main = written(tmp_path, program.files) / program.main
    assert subprocess.run([sys.executable, main], capture_output=True, text=True, check=True).stdout == "20 0.25\n"


def test_several_programs_are_found_in_a_package_by_what_they_define(pair: Exercise) -> None:
    names = {**inside("p"), "p/my_robot/one.py": COUNTER, "p/my_robot/two.py": DOUBLER}
    submission = of_content("p.zip", zipped(names), pair)
    assert submission.program
    assert {"counter.py", "doubler.py", "my_robot/one.py", "my_robot/two.py"} <= set(submission.program.files)
    assert b"my_robot.one" in submission.program.files["counter.py"]


def test_several_programs_keep_their_own_lines(pair: Exercise) -> None:
    submission = of_content("both.zip", zipped({"counter.py": COUNTER, "doubler.py": DOUBLER}), pair)
    assert submission.program
    assert submission.program.files == {"counter.py": COUNTER.encode(), "doubler.py": DOUBLER.encode()}


def test_modules_of_one_name_that_differ_are_a_question(pair: Exercise) -> None:
    files = {
        f"{name}/{name}.py": f"import rates\n{text}" for name, text in (("counter", COUNTER), ("doubler", DOUBLER))
    }
    same = {**files, "counter/rates.py": RATES, "doubler/rates.py": RATES}
    assert of_content("p.zip", zipped(same), pair).program
    question = of_content("p.zip", zipped({**same, "doubler/rates.py": "RATE = 1.0\n"}), pair).question
    assert question.startswith("rates.py is there in several versions, for doubler.py and for another program.")


def test_one_file_with_all_programs_is_read_in_a_zip_as_alone(pair: Exercise) -> None:
    alone = of_content("both.py", f"{COUNTER}{DOUBLER}".encode(), pair)
    assert of_content("p.zip", zipped({"both.py": f"{COUNTER}{DOUBLER}"}), pair).problem == alone.problem
    marked = f"# file: counter.py\n{COUNTER}# file: doubler.py\n{DOUBLER}"
    assert of_content("p.zip", zipped({"both.py": marked}), pair).program


def test_a_program_that_is_missing_is_named(pair: Exercise) -> None:
    submission = of_content("one.zip", zipped({"counter.py": COUNTER}), pair)
    assert (
        submission.problem
        == "There is no doubler.py in it, and no program of the node doubler. Python files: counter.py."
    )


QUESTIONS = {
    "two versions": {"a/heartbeat.py": PROGRAM, "b/heartbeat.py": OLD.partition("\n")[2]},
    "two of other names": {"new.py": PROGRAM, "old.py": OLD.partition("\n")[2]},
    "two notebooks": {"a.ipynb": notebook(NODE), "b.ipynb": notebook(OLD)},
    "cells": {"a.ipynb": notebook(NODE, OLD)},
    "an executable and its older source": {"beat": f"#!/usr/bin/python3\n{PROGRAM}", "beat.py": OLD.partition("\n")[2]},
    "a file and a notebook": {"heartbeat.py": PROGRAM, "a.ipynb": notebook(OLD)},
    "a file and a zip": {"heartbeat.py": PROGRAM, "all.zip": zipped({"heartbeat.py": OLD})},
    "two zips": {"v1.0.zip": zipped({"heartbeat.py": PROGRAM}), "v1.1.zip": zipped({"heartbeat.py": OLD})},
    "many outputs": {"a.ipynb": notebook(NODE) + b" " * 30_000_000},
    "a pointer": {"heartbeat.py": "version https://git-lfs.github.com/spec/v1\noid sha256:0\n"},
    "a download and another": {"heartbeat.py": PROGRAM, "heartbeat (1).py": OLD.partition("\n")[2]},
}


@pytest.mark.parametrize("files", QUESTIONS.values(), ids=QUESTIONS)
def test_two_programs_that_differ_are_a_question_and_no_score(
    files: dict[str, str | bytes], exercise: Exercise, grading: Grading
) -> None:
    submission = of_content("all.zip", zipped(files), exercise)
    assert submission.question
    assert not submission.program
    grade = grading.grade(submission)
    assert (grade.outcome, grade.score, grade.verdicts) == ("undecided", 0.0, ())
    assert grade.message.endswith(submission.question)
    assert not grade.has_score


def test_a_check_in_one_of_two_notebooks_says_which_counts(exercise: Exercise) -> None:
    files = {"a.ipynb": notebook(NODE, check_cell(digest_of(PROGRAM))), "b.ipynb": notebook(OLD)}
    assert digest_of(of_content("all.zip", zipped(files), exercise).source) == digest_of(PROGRAM)


def test_the_whole_handout_in_a_zip_is_read_by_the_notebook_in_it(exercise: Exercise) -> None:
    from grader.exercise import starter

    assert exercise.solution_file
    begin = starter(exercise.solution_file.read_text())
    files: dict[str, str | bytes] = {
        "course/03.ipynb": notebook(NODE),
        "course/exercises/heartbeat/heartbeat.py": begin,
        "course/exercises/heartbeat/checks.py": "def check(): pass\n",
        "course/.spinbook/base/03.ipynb": notebook(OLD),
        "course/.ipynb_checkpoints/03-checkpoint.ipynb": notebook(OLD),
    }
    submission = of_content("course.zip", zipped(files), exercise)
    assert digest_of(submission.source) == digest_of(PROGRAM)


def damaged(files: dict[str, str | bytes], name: str) -> bytes:
    """Return a zip in which this file can't be read."""
    content = bytearray(zipped(files))
    content[content.find(name.encode()) + len(name) + 5] ^= 0xFF
    return bytes(content)


def test_a_program_that_is_damaged_is_not_replaced_by_another_file_in_silence(exercise: Exercise) -> None:
    files: dict[str, str | bytes] = {"heartbeat.py": PROGRAM, "old.py": OLD.partition("\n")[2]}
    question = of_content("all.zip", damaged(files, "heartbeat.py"), exercise).question
    assert question == "heartbeat.py in it can't be read, and old.py may be an older version of it."
    files["old.py"] = "print(1)\n"
    problem = of_content("all.zip", damaged(files, "heartbeat.py"), exercise).problem
    assert problem.startswith("heartbeat.py in it can't be read (is it damaged, or has it a password?)")


@pytest.mark.parametrize("name", ["heartbeat.py", "beat_node.py"])
def test_a_file_that_starts_the_node_of_another_is_the_program(name: str, exercise: Exercise) -> None:
    start = f"import rclpy\nfrom {name[:-3]} import Heartbeat\n\nrclpy.init()\nrclpy.spin(Heartbeat())\n"
    submission = of_content("all.zip", zipped({name: PROGRAM.partition("def main")[0], "main.py": start}), exercise)
    assert submission.source == start
    assert submission.program
    assert submission.program.main == "main.py"
    assert submission.notes == (f"Taken: main.py, because it starts what {name} defines.",)


def test_a_notebooks_program_brings_the_modules_beside_it(exercise: Exercise) -> None:
    files = {"w/week3.ipynb": notebook(f"%%node heartbeat\n{IN_PACKAGE}"), "w/other.py": b"x = 1\n"}
    files |= {f"w/my_robot/{name}.py": PACKAGE[f"my_robot/{name}.py"].encode() for name in ("__init__", "rates")}
    submission = of_content("w.zip", zipped(files), exercise)
    assert submission.program
    assert sorted(submission.program.files) == ["heartbeat.py", "my_robot/__init__.py", "my_robot/rates.py"]


MANY_ZIPS = zipped({f"{i}.zip": zipped({}) for i in range(400)})
HOSTILE = {
    "a file that is also a folder": zipped({"a": "x", "a/heartbeat.py": PROGRAM}),
    "names that lead elsewhere": zipped({"../../etc/heartbeat.py": PROGRAM, "/tmp/x.py": "x = 1\n"}),
    "a long name": zipped({f"{'x' * 300}.py": "x = 1\n", "heartbeat.py": PROGRAM}),
    "a deep path": zipped({f"{'d/' * 1500}x.py": "x = 1\n", "heartbeat.py": PROGRAM}),
    "a zip that holds itself many times": zipped(
        {f"{i}.zip": zipped({f"{j}.zip": zipped({"x.py": PROGRAM}) for j in range(5)}) for i in range(5)}
    ),
    "a zip of many zips": zipped({f"{i}.zip": MANY_ZIPS for i in range(400)}),
    "a broken zip beside": zipped({"x.zip": b"PK\3\4rubbish", "heartbeat.py": PROGRAM}),
    "a bomb in a tar": tarred({"x.py": bytes(70_000_000), "heartbeat.py": PROGRAM}),
    "a truncated tar": tarred({"heartbeat.py": PROGRAM})[:100],
    "a tar that ends before its end": tarred({"heartbeat.py": PROGRAM, "rates.py": RATES}, "")[:1800],
    "a notebook of many versions": zipped({"a.ipynb": notebook(*[NODE + f"# {n}\n" for n in range(60)])}),
    "magics without end": zipped({"heartbeat.py": "# %%n\n" * 5_000 + f"# {NODE}"}),
    "not an archive": b"PK\3\4",
    "a setup.py without end": zipped({"setup.py": "(" * 100_000, "package.xml": "<", "heartbeat.py": PROGRAM}),
    "a setup.py whose strings double": zipped(
        {"setup.py": "a = ':'\n" + "a = f'{a}{a}'\n" * 99 + "b" + " + b" * 999, "heartbeat.py": PROGRAM}
    ),
    "a pyproject.toml of rubbish": zipped({"pyproject.toml": "[project]\nscripts = 3\n[x", "heartbeat.py": PROGRAM}),
    "a setup.cfg of rubbish": zipped({"setup.cfg": "[[[\n=\n", "heartbeat.py": PROGRAM}),
}


@pytest.mark.parametrize("content", HOSTILE.values(), ids=HOSTILE)
@pytest.mark.timeout(60)
def test_an_upload_made_to_do_harm_does_none(content: bytes, exercise: Exercise) -> None:
    submission: Submission = of_content("x.zip", content, exercise)
    assert bool(submission.program) != bool(submission.problem or submission.question)
    if submission.program:
        assert digest_of(submission.source) == digest_of(PROGRAM)


def test_messages_of_their_own_are_a_question_unless_they_are_the_courses(
    exercise: Exercise, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    files = {
        **inside("src/my_robot"),
        "src/my_msgs/package.xml": MANIFEST.replace("my_robot", "my_msgs"),
        "src/my_msgs/msg/Beat.msg": "float64 rate\n",
    }
    assert of_content("ws.zip", zipped(files), exercise).program
    files["src/my_robot/my_robot/beat_node.py"] = f"from my_msgs.msg import Beat\n{IN_PACKAGE}"
    question = of_content("ws.zip", zipped(files), exercise).question
    helped = {**files, "src/my_robot/my_robot/beat_node.py": IN_PACKAGE}
    helped["src/my_robot/my_robot/rates.py"] = f"from my_msgs.msg import Beat\n{RATES}"
    assert of_content("ws.zip", zipped(helped), exercise).question == question
    assert "imports my_msgs" in question
    assert "the course's folder interfaces/my_msgs/" in question
    (tmp_path / "my_msgs").mkdir()
    (tmp_path / "my_msgs" / "__init__.py").touch()
    monkeypatch.syspath_prepend(tmp_path)
    submission = of_content("ws.zip", zipped(files), exercise)
    assert submission.program
    assert "The course's my_msgs is used, not the one that was handed in." in submission.notes


@pytest.mark.parametrize(
    ("name", "text", "words"),
    [
        ("a.launch.py", "Node(executable='beat', remappings=[('a', 'b')], namespace='x')", "remappings, namespace"),
        ("a.launch.py", "Node(executable='beat', parameters=[{'rate': 4.0}])", "parameters"),
        ("a.launch.py", "Node(executable='another', namespace='x')", ""),
        ("start.py", "def generate_launch_description():\n    Node(executable='beat', namespace='x')", "namespace"),
        ("a.launch.py", "Node(executable='beat', name='mine')", "the node's name"),
        ("a.launch.py", "Node(executable='beat', name='heartbeat')", ""),
        ("a.launch.py", "SetRemap('a', 'b'); Node(executable='beat')", "what it sets for a group"),
        ("a.launch.py", "Node(package='my_robot', executable='beat', output='screen')", ""),
        ("a.launch.xml", '<launch><node exec="beat" namespace="x"/><node exec="y" args="z"/></launch>', "namespace"),
        ("a.launch.xml", '<launch><node exec="beat"><remap from="a" to="b"/></node></launch>', "remappings"),
        (
            "a.launch.yaml",
            "launch:\n- node:\n    exec: beat\n    param:\n    - name: r\n- node:\n    exec: y\n",
            "parameters",
        ),
    ],
)
def test_what_a_launch_file_sets_is_said_not_to_be_applied(
    exercise: Exercise, name: str, text: str, words: str
) -> None:
    files = {**inside("src/my_robot"), f"src/my_robot/launch/{name}": text}
    notes = [note for note in of_content("ws.zip", zipped(files), exercise).notes if "launch file" in note]
    assert len(notes) == bool(words)
    assert all(note.startswith(f"Not applied from your launch file: {words}. The grader starts the") for note in notes)
