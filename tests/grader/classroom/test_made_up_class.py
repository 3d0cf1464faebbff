"""The class that `make class` grades: the same each time, like a real one, with grades that are really compared."""

from __future__ import annotations

import ast
import json
import random
import subprocess
import sys
from collections import Counter
from pathlib import Path
from typing import Any

import pytest
from small_class import ROOT

from grader.exercise import load
from grader.exercise.mistakes import mistakes_of

sys.path.append(str(ROOT / "benchmarks" / "class"))
import grades
import students
import variants


def digests(folder: Path) -> dict[str, bytes]:
    """Return what each student of a class of 40 submits, except huge files."""
    students.write(students.the_class(40, 5), folder)
    found = [file for file in folder.rglob("*") if file.is_file() and not file.is_symlink()]
    return {str(file.relative_to(folder)): file.read_bytes() for file in found if file.stat().st_size < 10**8}


def test_the_same_seed_makes_the_same_class_in_which_all_differ(tmp_path: Path) -> None:
    one, another = digests(tmp_path / "one"), digests(tmp_path / "another")
    assert one == another
    assert len(set(one.values())) >= len(one) - 2, "odd names have one content"


def test_it_is_mostly_right_with_mistakes_and_a_few_attacks() -> None:
    made = students.the_class(200, 1)
    assert len({handed.student for handed in made}) == 200
    assert Counter(handed.kind for handed in made) == {"right": 110, "mistake": 60, "hostile": 24, "odd file": 6}
    mistakes = {mistake.name for mistake in mistakes_of(load(ROOT / "exercises" / students.EXERCISE))}
    made_wrong = {handed.origin for handed in made if handed.kind == "mistake"}
    assert made_wrong <= mistakes
    assert len(made_wrong) == min(60, len(mistakes)), "none twice as long as there are others"


def shape(source: str) -> list[type]:
    return [type(node) for node in ast.walk(ast.parse(source))]


def test_another_students_words_leave_the_program_as_it_was() -> None:
    source = "def f(a):\n    b = a + 1\n    return b\n\n\nprint(f(41))\n"
    worded = {variants.reworded(source, "Ada", random.Random(seed)) for seed in range(8)}
    assert len(worded) > 4
    for text in worded:
        compile(text, "f.py", "exec")
        assert [type(node) for node in ast.walk(ast.parse(text))] == [
            type(node) for node in ast.walk(ast.parse(source))
        ]
        done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=True)
        assert done.stdout == "42\n"


RIGHT = {"name": "test_a", "title": "A.", "status": "passed", "points": 6, "finding": None, "blocked_by": []}
WRONG = {**RIGHT, "name": "test_b", "status": "failed", "points": 4, "finding": {"text": "expected 1, got 2"}}


def problem_of(tmp_path: Path, expected: students.Expected, *verdicts: dict[str, Any], **fields: Any) -> str:
    score = sum(one["points"] if one["status"] == "passed" else one.get("earned", 0) for one in verdicts)
    grade = {"outcome": "graded", "message": "", "score": score, "points": 10, "log": "", "verdicts": verdicts}
    (tmp_path / "students" / "Ada_Abe").mkdir(parents=True, exist_ok=True)
    entry = {"final": score, "grade": {**grade, **fields}}
    (tmp_path / "students" / "Ada_Abe" / "grade.json").write_text(json.dumps(entry))
    handed = students.Handed("Ada Abe", "right", "solution", expected, lambda folder: None)
    return grades.wrong_with(handed, tmp_path)


FAILS_B = students.Expected(("graded",), "less", frozenset({"test_b"}))


@pytest.mark.parametrize(
    ("expected", "verdicts", "fields", "message"),
    [
        (FAILS_B, [RIGHT, WRONG], {}, ""),
        (FAILS_B, [RIGHT, {**WRONG, "status": "passed"}], {}, "not less"),
        (FAILS_B, [{**RIGHT, "status": "failed"}, WRONG], {}, "not ['test_b']"),
        (FAILS_B, [RIGHT, WRONG], {"score": 7}, "the checks give 6"),
        (FAILS_B, [RIGHT, {**WRONG, "partial": True, "earned": 2.5}], {}, ""),
        (FAILS_B, [RIGHT, {**WRONG, "partial": False, "earned": 2.5}], {}, "the checks give 6"),
        (FAILS_B, [RIGHT, WRONG], {"outcome": "crashed"}, "crashed, not graded"),
        (students.Expected(words=("line 4",), score="less"), [RIGHT, WRONG], {}, "the feedback lacks ['line 4']"),
        (students.Expected(never=("FOUND",), score="any"), [RIGHT], {"log": "FOUND it"}, "an attack has worked"),
    ],
)
def test_a_grade_that_is_not_what_it_must_be_is_seen(
    tmp_path: Path, expected: students.Expected, verdicts: list[dict[str, Any]], fields: dict[str, Any], message: str
) -> None:
    found = problem_of(tmp_path, expected, *verdicts, **fields)
    assert message in found
    assert bool(found) == bool(message)


def test_a_grade_that_is_missing_is_seen(tmp_path: Path) -> None:
    handed = students.Handed("Ada Abe", "right", "solution", students.Expected(), lambda folder: None)
    assert grades.wrong_with(handed, tmp_path) == "there is no grade"


@pytest.mark.soak
def test_a_whole_class_gets_what_it_must_get(tmp_path: Path) -> None:
    program = ROOT / "benchmarks" / "class" / "grade_all.py"
    command = [sys.executable, str(program), "--count", "60", "--seed", "2", "--out", str(tmp_path / "class")]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert "60 of 60 grades are what they must be." in done.stdout, done.stdout[-3000:]
