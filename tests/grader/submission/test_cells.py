"""Of several cells the one counts that the student means; if nobody can know, it is a question and no score."""

from __future__ import annotations

import pytest
from student_work import (
    BEAT,
    CLASS,
    EXERCISE,
    GUARD,
    IMPORTS,
    INIT,
    MAIN,
    NODE,
    OLD,
    PROGRAM,
    cell,
    check_cell,
    notebook,
)

from grader.exercise import Exercise, starter
from grader.grading.grading import Grading
from grader.recording.places import place_of
from grader.submission.code import Code, code_of
from grader.submission.problems import AmbiguousProgram, Unreadable
from grader.submission.program_choice import digest_of
from grader.submission.python_code import missing, normalized, starts
from grader.submission.reader import of_code


def code_in(content: bytes, exercise: Exercise) -> Code:
    return code_of("week3.ipynb", content, exercise)


def is_program(code: Code, expected: str = PROGRAM) -> bool:
    return normalized(code.source) == normalized(expected)


def handed_out(exercise: Exercise) -> str:
    assert exercise.solution_file
    return "%%node heartbeat\n" + starter(exercise.solution_file.read_text())


BESIDE = {
    "notes in a copy": cell("# my notes: 0.5 was wrong\n", EXERCISE),
    "a copy turned into text": cell("'''\n" + PROGRAM + "'''\n", EXERCISE),
    "an empty copy": cell("", EXERCISE),
    "a copy with its first line alone": cell("%%node heartbeat\n", EXERCISE),
    "a copy with only comments": cell("%%node heartbeat\n# TODO\n", EXERCISE),
    "the same once more": cell(NODE, EXERCISE),
    "the same with notes in it": cell(
        NODE.replace("    def beat", "    # 4 Hz!\n\n    def beat") + "# done\n", EXERCISE
    ),
    "a scratch cell with its own magic": cell("%%node scratch\n" + PROGRAM.replace("0.25", "1.0"), EXERCISE),
    "a try of something else": cell("%%node heartbeat\nprint('hello')\n", EXERCISE),
    "bash": cell("%%bash\nclass Heartbeat\n", EXERCISE),
}


@pytest.mark.parametrize("other", BESIDE.values(), ids=BESIDE)
@pytest.mark.parametrize("below", [True, False], ids=["below", "above"])
def test_a_copy_without_a_program_of_its_own_does_not_count(other: object, below: bool, exercise: Exercise) -> None:
    mine = cell(NODE, EXERCISE)
    code = code_in(notebook(mine, other) if below else notebook(other, mine), exercise)
    assert is_program(code)


def test_which_cell_was_taken_is_said_and_why(exercise: Exercise) -> None:
    code = code_in(notebook(cell(NODE, EXERCISE), cell("# notes", EXERCISE)), exercise)
    assert code.notes == (
        '2 cells of the notebook are for this exercise. Taken: code cell 1 ("%%node heartbeat"), because the other one '
        "has no program.",
    )
    assert code_in(notebook(NODE, "x = 1"), exercise).notes == ()
    # An older version in an ordinary cell, or below another name, is not hidden.
    for other in (PROGRAM.replace("0.25", "0.5"), OLD.replace("%%node heartbeat", "%%node try1")):
        assert "because it is the exercise's own cell" in code_in(notebook(other, NODE), exercise).notes[0]


@pytest.mark.parametrize("order", [(NODE, OLD), (OLD, NODE)])
def test_of_two_versions_the_one_counts_that_check_judged_last(order: tuple[str, str], exercise: Exercise) -> None:
    first, second = digest_of(OLD.partition("\n")[2]), digest_of(PROGRAM)
    code = code_in(notebook(*order, check_cell(first, ran=3), check_cell(second, ran=7)), exercise)
    assert is_program(code)
    assert "because it is the one that %check judged last" in code.notes[0]
    # Of two checks the one that ran later counts, wherever it stands.
    assert is_program(code_in(notebook(check_cell(second, ran=7), *order, check_cell(first, ran=3)), exercise))


def test_the_starter_does_not_count_beside_the_students_work(exercise: Exercise) -> None:
    code = code_in(notebook(NODE, handed_out(exercise)), exercise)
    assert is_program(code)
    assert "because the others are still the starter" in code.notes[0]


@pytest.mark.parametrize("cells", [(NODE, OLD), (NODE, OLD, "%check heartbeat"), (NODE, OLD, check_cell("0" * 64))])
def test_two_versions_and_nothing_that_tells_is_a_question(cells: tuple[object, ...], exercise: Exercise) -> None:
    with pytest.raises(
        AmbiguousProgram, match=r"2 cells of the notebook can be heartbeat\.py, they differ, and no saved"
    ):
        code_in(notebook(*cells), exercise)


SPIN = """\
try:
    rclpy.spin(node)
except (KeyboardInterrupt, rclpy.executors.ExternalShutdownException):
    pass
"""
PIECES = {
    "split between functions": [
        cell(f"%%node heartbeat\n{IMPORTS}\n{CLASS}", EXERCISE),
        cell(f"{MAIN}\n{GUARD}", EXERCISE),
    ],
    "split in the class": [
        cell(f"%%node heartbeat\n{IMPORTS}\n{INIT}", EXERCISE),
        cell(f"{BEAT}\n{MAIN}\n{GUARD}", EXERCISE),
    ],
    "split in three": [
        cell(f"%%node heartbeat\n{IMPORTS}\n{INIT}", EXERCISE),
        cell(BEAT, EXERCISE),
        cell(f"{MAIN}\n{GUARD}", EXERCISE),
    ],
    "split in a bracket": [
        cell(f"%%node heartbeat\n{PROGRAM.partition('(Header, ')[0]}(\n"),
        cell("Header, " + PROGRAM.partition("(Header, ")[2]),
    ],
    "parts": [
        f"%%part common\n{IMPORTS}",
        f"%%part beats\n{CLASS}",
        f"%%node heartbeat --after common beats\n{MAIN}\n{GUARD}",
    ],
    "parts that are kept": [
        f"%%part common --keep\n{IMPORTS}",
        f"%%part beats --keep\n{CLASS}",
        f"%%node heartbeat --after common beats --keep\n{MAIN}\n{GUARD}",
    ],
    "a part and an old version of it": [
        f"%%part beats\n{IMPORTS}\n{CLASS.replace('0.25', '0.5')}",
        f"%%part beats\n{IMPORTS}\n{CLASS}",
        f"%%node heartbeat --after beats\n{MAIN}\n{GUARD}",
    ],
    "plain cells": [IMPORTS, CLASS, MAIN, "main()\n"],
    "plain cells with commands": ["%pip install x\n!ls\n" + IMPORTS, CLASS, "%%bash\nls\n", MAIN, "%time main()\n"],
    "plain cells, spun at the top": [f"{IMPORTS}rclpy.init()\n", CLASS, f"node = Heartbeat()\n{SPIN}"],
    "plain cells, init in its own": [IMPORTS, "rclpy.init()\n", CLASS, "node = Heartbeat()\n", SPIN],
    "imports in a cell below": [f"%%node heartbeat\n{CLASS}\n{MAIN}\n{GUARD}", IMPORTS],
    "a class that Spinbook starts": [f"%%node heartbeat --class Heartbeat\n{IMPORTS}\n{CLASS}"],
    "a main that Spinbook calls": [f"%%node heartbeat --main\n{IMPORTS}\n{CLASS}\n{MAIN}"],
    "imports that Spinbook adds": [f"%%node heartbeat --usual-imports --main\n{CLASS}\n{MAIN}"],
    "parts that all have the exercise's magic": [
        f"%%node heartbeat\n{IMPORTS}\n{INIT}",
        f"%%node heartbeat\n{BEAT}",
        f"%%node heartbeat\n{MAIN}\n{GUARD}",
    ],
    "other cells between": [
        IMPORTS,
        "import matplotlib.pyplot as plt\nplt.plot([1])\n",
        CLASS,
        "print(1)\n",
        MAIN,
        GUARD,
    ],
    "a file that the notebook writes": [f"%%writefile src/heartbeat.py\n{PROGRAM}", "!python3 src/heartbeat.py\n"],
}


@pytest.mark.parametrize("cells", PIECES.values(), ids=PIECES)
def test_a_program_in_pieces_is_put_together_as_the_kernel_would_run_it(
    cells: list[object], exercise: Exercise
) -> None:
    code = code_in(notebook(*cells), exercise)
    assert missing(code.source) == set()
    assert starts(code.source)
    assert "0.25" in code.source
    assert "0.5" not in code.source
    assert "matplotlib" not in code.source


@pytest.mark.parametrize("name", ["split in three", "parts that are kept", "plain cells, init in its own"])
def test_a_program_in_pieces_runs(name: str, exercise: Exercise, grading: Grading) -> None:
    code = code_in(notebook(*PIECES[name]), exercise)
    assert grading.grade(of_code("week3.ipynb", code, exercise)).full_marks


def test_a_line_of_a_program_in_pieces_has_its_cell_and_its_line_there(exercise: Exercise) -> None:
    code = code_in(
        notebook("x = 1", f"%%part beats\n{IMPORTS}\n{CLASS}", f"%%node heartbeat --after beats\n{MAIN}{GUARD}"),
        exercise,
    )
    lines = code.source.split("\n")
    expected = 1 + f"%%part beats\n{IMPORTS}\n{CLASS}".split("\n").index("    def beat(self):")
    assert place_of(code.source, 1 + lines.index("    def beat(self):")) == (2, expected)
    assert place_of(code.source, 1 + lines.index("    rclpy.init()")) == (3, 3)
    assert "consists of the code cells 2, 3 of the notebook" in code.notes[0]


def test_a_module_that_another_cell_defines_comes_along(exercise: Exercise) -> None:
    helper = "%%node rates --keep\nRATE = 0.25\n"
    chapter = "%load_ext spinbook\n%chapter 03 --package humanoid_control\n"
    for line in ("from humanoid_control.rates import RATE\n", "from rates import RATE\n"):
        code = code_in(notebook(chapter, helper, NODE.replace(IMPORTS, line + IMPORTS)), exercise)
        assert {"heartbeat.py", line.split()[1].replace(".", "/") + ".py"} == set(code.files)


def test_two_programs_are_two_cells(pair: Exercise) -> None:
    cells = [
        f"%%node {name}\nimport rclpy\nrclpy.spin(rclpy.create_node('{name}'))\n" for name in ("counter", "doubler")
    ]
    code = code_in(notebook(*cells), pair)
    assert set(code.files) == {"counter.py", "doubler.py"}


@pytest.mark.parametrize("cells", [[""], ["%%node heartbeat\n"], ["%%node heartbeat\n# soon\n"]])
def test_an_exercise_that_nobody_has_begun_is_reported(cells: list[str], exercise: Exercise) -> None:
    with pytest.raises(Unreadable, match=r"empty|None of the notebook's 1 code cells"):
        code_in(notebook(*cells), exercise)


@pytest.mark.parametrize("magic", ["%%nod heartbeat", "%%Node Heartbeat", "%%mode heartbeat"])
def test_a_cell_whose_command_is_misspelt_is_named(magic: str, exercise: Exercise) -> None:
    with pytest.raises(
        Unreadable, match=rf'code cell 1 \("{magic}"\) begins with a command .* Write %%node heartbeat,'
    ):
        code_in(notebook(f"{magic}\n{BEAT}"), exercise)


def test_what_a_program_in_pieces_prints_has_its_cells_and_their_lines(exercise: Exercise, grading: Grading) -> None:
    broken = BEAT.replace("message = Header", "import warnings; warnings.warn('odd'); message = Head")
    content = notebook(IMPORTS, "x = 1\n", f"{INIT}\n{broken}", f"%%node heartbeat\n{MAIN}\n{GUARD}")
    grade = grading.grade(of_code("week3.ipynb", code_of("week3.ipynb", content, exercise), exercise))
    line = f"{INIT}\n{broken}".split("\n").index(next(one for one in broken.split("\n") if "Head(" in one)) + 1
    assert f"code cell 3, line {line}, in beat" in grade.log
    assert f"code cell 3, line {line}: UserWarning: odd" in grade.log
    assert "heartbeat.py" not in grade.log
