"""What is wrong with a machine stops a class, or does not matter: it never becomes a student's zero."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from prepared_python import run_prepared
from small_class import EXERCISE, SmallClass

from groundwork.clean_environment import GUARD

#: Modules that a grade needs, as another installation may have them.
FOREIGN = ("numpy", "rclpy", "std_msgs", "click", "typing", "yaml")


@pytest.fixture
def foreign(tmp_path: Path) -> Path:
    """A folder with broken modules, and a sitecustomize.py that prints."""
    folder = tmp_path / "foreign"
    folder.mkdir()
    for name in FOREIGN:
        (folder / f"{name}.py").write_text(f"raise ImportError('the wrong {name}')\n")
    (folder / "sitecustomize.py").write_text("import sys; sys.modules['_of_another_installation'] = sys\n")
    return folder


def carls_grade(small: SmallClass) -> str:
    """Return what a new Python prints that grades one of the class, who loses points."""
    command = [sys.executable, "-m", "grader", EXERCISE, "submissions/carl.py"]
    done = subprocess.run(command, cwd=small.folder, env=small.environment, capture_output=True, text=True, check=False)
    assert done.returncode == 1, done.stdout + done.stderr
    return done.stdout


def test_another_installations_variables_change_no_grade(
    small_class: SmallClass, foreign: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("PYTHONPATH", "LD_LIBRARY_PATH", "AMENT_PREFIX_PATH", "CMAKE_PREFIX_PATH", "PYTHONUSERBASE"):
        monkeypatch.setenv(name, str(foreign))
    for name in (
        "PYTHONOPTIMIZE",
        "PYTHONINSPECT",
        "PYTHONSAFEPATH",
        "ROS_SECURITY_ENABLE",
        "RCUTILS_COLORIZED_OUTPUT",
        GUARD,
    ):
        monkeypatch.setenv(name, "1")
    monkeypatch.setenv("PYTHONWARNINGS", "error")
    monkeypatch.setenv("RMW_IMPLEMENTATION", "rmw_cyclonedds_cpp")
    monkeypatch.setenv("ROS_LOG_DIR", "/proc/nowhere")
    monkeypatch.setenv("ROS_DISTRO", "humble")

    assert "15 of 20 points" in carls_grade(small_class)


def test_files_of_students_in_the_current_folder_are_not_the_graders_modules(small_class: SmallClass) -> None:
    for name in (*FOREIGN, "queue", "socket", "pickle", "grade"):
        (small_class.folder / f"{name}.py").write_text(f"raise SystemExit('the wrong {name}')\n")

    assert "15 of 20 points" in carls_grade(small_class)


def test_a_machine_on_which_the_solution_no_longer_passes_stops_the_class_with_the_cause(
    small_class: SmallClass,
) -> None:
    solution = small_class.folder / "solutions" / EXERCISE / "solution.py"
    needs = "import os\nassert os.environ['LANG'] != 'xx_XX', 'no such language'\n"
    solution.write_text(needs + solution.read_text(encoding="utf-8"), encoding="utf-8")

    def grade(language: str, *words: str) -> tuple[int, str]:
        environment = {**small_class.environment, "LANG": language}
        done = run_prepared("grader", EXERCISE, *words, cwd=small_class.folder, env=environment, merged=True)
        return done.returncode, done.stdout

    assert grade("C.UTF-8", "submissions/fay.py")[0] == 1, "its solution passes here"
    code, printed = grade("xx_XX", "submissions", "--out", "results")

    assert code == 3
    assert "got full marks here before, and no longer does" in printed
    assert "no such language" in printed
    assert "Traceback" not in printed
    assert small_class.finals() == {}
    assert not (small_class.folder / "results" / "grades.csv").exists()
