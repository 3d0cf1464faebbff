"""The usual mistakes in an exercise: edits of the solution in mistakes.md, or whole programs in mistakes/."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from grader.exercise import Exercise, ExerciseError, load
from grader.exercise.mistakes import EDITS, Mistake, NoMistake, each_mistake, mistake_of, mistakes_of

ROOT = Path(__file__).parents[3]
SOLUTION = """\
class Node:
    def start(self):
        self.count = 0
        self.say()

    def stop(self):
        self.count = 0
        self.say()
"""


@pytest.fixture
def exercise(tmp_path: Path) -> Exercise:
    (tmp_path / "solution.py").write_text(SOLUTION)
    return replace(load(ROOT / "exercises" / "heartbeat"), solution_folder=tmp_path)


def write_edit(exercise: Exercise, diff: str, name: str = "wrong", text: str = "It is wrong.") -> None:
    assert exercise.solution_folder
    with (exercise.solution_folder / EDITS).open("a") as file:
        file.write(f"## {name}\n\n{text}\n\n```diff\n{diff}\n```\n\n")


def refusal(exercise: Exercise) -> ExerciseError:
    with pytest.raises(ExerciseError) as caught:
        mistakes_of(exercise)
    return caught.value


def test_a_mistake_is_the_solution_with_some_lines_replaced(exercise: Exercise) -> None:
    text = "It counts\nfrom one.\n\nBreaks: “Count from\nzero.”\n\nCaught by: test_first, `test_second`"
    write_edit(
        exercise,
        " def start(self):\n-        self.count = 0\n+        self.count = 1".replace(" d", "     d"),
        text=text,
    )
    (mistake,) = mistakes_of(exercise)
    assert mistake.source == SOLUTION.replace("self.count = 0", "self.count = 1", 1)
    assert (mistake.name, mistake.summary, mistake.breaks) == ("wrong", "It counts from one.", ("Count from zero.",))
    assert mistake.caught_by == ("test_first", "test_second")
    assert mistake.line == 1


def test_lines_are_also_added_and_removed_and_in_several_places(exercise: Exercise) -> None:
    diff = " class Node:\n+    tag = 1\n@@\n-    def stop(self):\n-        self.count = 0\n-        self.say()"
    write_edit(exercise, diff)
    source = mistake_of(exercise, "wrong").source
    assert source.startswith("class Node:\n    tag = 1\n    def start")
    assert "stop" not in source


def test_a_line_of_the_base_tells_which_of_several_places_is_meant(exercise: Exercise) -> None:
    write_edit(exercise, "@@ def stop\n-        self.count = 0\n+        self.count = 9")
    assert mistake_of(exercise, "wrong").source == "9".join(SOLUTION.rsplit("0", 1))


def test_a_unified_diff_as_diff_and_git_write_it_works_as_it_is(exercise: Exercise) -> None:
    diff = (
        "--- a/solution.py\n+++ b/wrong.py\n@@ -5,4 +5,4 @@ class Node:\n \n"
        "     def stop(self):\n-        self.count = 0\n+        self.count = 9\n         self.say()\n"
    )
    write_edit(exercise, diff)
    assert mistake_of(exercise, "wrong").source == "9".join(SOLUTION.rsplit("0", 1))


def test_an_edit_may_be_one_of_another_program(exercise: Exercise) -> None:
    assert exercise.solution_folder
    (exercise.solution_folder / "right").mkdir()
    (exercise.solution_folder / "right" / "other.py").write_text("a = 1\nb = 2\n")
    write_edit(exercise, "--- right/other.py\n+++ right/other.py\n-b = 2\n+b = 3")
    assert mistake_of(exercise, "wrong").source == "a = 1\nb = 3\n"


def test_whole_programs_stand_beside_edits(exercise: Exercise) -> None:
    assert exercise.solution_folder
    write_edit(exercise, " class Node:\n+    tag = 1", name="tagged")
    folder = exercise.solution_folder / "mistakes"
    folder.mkdir()
    (folder / "alone.py").write_text('"""Nothing of it is right.\n\nCaught by:\n- test_all\n"""\n')
    alone, tagged = mistakes_of(exercise)
    assert (alone.name, alone.summary, alone.caught_by) == ("alone", "Nothing of it is right.", ("test_all",))
    assert tagged.name == "tagged"
    (folder / "tagged.py").write_text("")
    assert "also a whole program called tagged" in str(refusal(exercise))


@pytest.mark.parametrize(
    ("diff", "line", "says"),
    [
        ("-        self.count = 7\n+        pass", 6, "solution.py has no line “self.count = 7”"),
        ("-        self.count = 7\n+        pass", 6, "It has “self.count = 0”."),
        ("-        self.count = 0\n+        pass", 6, "the diff fits solution.py in lines 3, 7"),
        ("+        pass", 6, "the diff adds lines, and does not say where"),
        ("-        self.say()\n-        self.count = 0", 6, "but not in this order"),
        ("@@ def pause\n-        self.count = 0", 7, "a place below “def pause”, which is not in solution.py"),
        ("--- nowhere.py\n+++ nowhere.py\n-x", 1, "it changes nowhere.py, and there is no such file"),
        ("", 1, "wrong: it has no diff"),
    ],
)
def test_an_edit_that_does_not_fit_is_an_error_with_its_line(
    exercise: Exercise, diff: str, line: int, says: str
) -> None:
    write_edit(exercise, diff)
    error = refusal(exercise)
    assert says in str(error)
    assert (error.problem.file.name, error.problem.line) == (EDITS, line)


def test_one_edit_that_does_not_fit_hides_no_other(exercise: Exercise) -> None:
    write_edit(exercise, "-gone", name="first")
    write_edit(exercise, " class Node:\n+    tag = 1", name="second")
    first, second = each_mistake(exercise)
    assert isinstance(first, ExerciseError)
    assert isinstance(second, Mistake)


@pytest.mark.parametrize(
    ("names", "says"), [(("a", "a"), "the other is in line 1"), (("two words",), "can't be the name")]
)
def test_names_are_single_words_and_stand_once(exercise: Exercise, names: tuple[str, ...], says: str) -> None:
    for name in names:
        write_edit(exercise, " class Node:\n+    tag = 1", name=name)
    assert says in str(refusal(exercise))


def test_an_unknown_name_is_answered_with_the_names_that_there_are(exercise: Exercise) -> None:
    write_edit(exercise, " class Node:\n+    tag = 1")
    with pytest.raises(NoMistake, match=r"no mistake called wrung\. It has: wrong\."):
        mistake_of(exercise, "wrung")


def test_a_file_without_headings_has_no_mistakes(exercise: Exercise) -> None:
    assert exercise.solution_folder
    (exercise.solution_folder / EDITS).write_text("# Usual mistakes\n\nNone yet.\n")
    assert list(each_mistake(exercise)) == []
