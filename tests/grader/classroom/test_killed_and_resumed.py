"""However a run ends, nothing is left running, and the next one continues to the same results."""

from __future__ import annotations

import os
import random
import shutil
import signal
import subprocess

import pytest
from process_mark import ProcessMark
from small_class import POINTS, SmallClass, without_timings


@pytest.fixture
def undisturbed(graded: tuple[SmallClass, str]) -> dict[str, str]:
    """The results of an undisturbed run."""
    return without_timings(graded[0].folder / "results")


def killed(small: SmallClass, after: int) -> int:
    """Start a run, kill it when `after` students have a grade, and return how many have one then."""
    process = small.start("--jobs", "2")
    small.wait_for_grades(after, process)
    process.send_signal(signal.SIGKILL)
    process.communicate()
    return len(small.finals())


def interrupted(small: SmallClass) -> str:
    """Press Ctrl-C when some students have a grade and others have none yet; return what is printed then."""
    for _ in range(5):  # on a busy machine the run may end before the signal arrives
        process = small.start("--jobs", "2")
        small.wait_for_grades(1, process)
        process.send_signal(signal.SIGINT)
        printed, _ = process.communicate(timeout=240)
        if process.returncode == 130:
            return printed
        assert process.returncode == 0, printed
        shutil.rmtree(small.folder / "results")
    raise AssertionError("every run came to its end before Ctrl-C")


def test_interrupted_then_killed_then_resumed_it_is_as_if_nothing_had_been(
    undisturbed: dict[str, str], small_class: SmallClass, process_mark: ProcessMark
) -> None:
    printed = interrupted(small_class)
    there = len(small_class.finals())
    assert f"{there} of {len(POINTS)} are graded and kept. Run the same command to continue." in printed
    assert "Traceback" not in printed
    process_mark.wait_until_none(60)
    assert 1 <= there < len(POINTS)

    kept = killed(small_class, there + 1)
    assert there < kept <= len(POINTS)
    process_mark.wait_until_none(60)

    code, printed = small_class.grade()
    assert code == 0, printed
    assert f"{kept} unchanged since they were graded." in printed
    assert without_timings(small_class.folder / "results") == undisturbed


@pytest.mark.soak
def test_killed_at_ten_random_moments(
    undisturbed: dict[str, str], small_class: SmallClass, process_mark: ProcessMark
) -> None:
    chance = random.Random(os.environ.get("SPINBOOK_SEED", "4"))
    for round_ in range(10):
        process = small_class.start("--jobs", "2")
        try:
            process.communicate(timeout=chance.uniform(0.1, 9.0))
        except subprocess.TimeoutExpired:
            process.kill()
            process.communicate()
        process_mark.wait_until_none(60)
        leftovers = [file for file in (small_class.folder / "results").rglob("*.json") if file.stat().st_size == 0]
        assert not leftovers, f"half a file in round {round_}"
        if len(small_class.finals()) == len(POINTS):
            for student in chance.sample(sorted(POINTS), 4):
                (small_class.folder / "results" / "students" / student / "grade.json").unlink()
    code, printed = small_class.grade()
    assert code == 0, printed
    assert without_timings(small_class.folder / "results") == undisturbed
