"""The files that an exercise gives to programs: what is in its folder `data`, such as a map, a bag or an image."""

from __future__ import annotations

from pathlib import Path

from grader.exercise.exercise import Exercise, ExerciseError

#: The folder, in an exercise's folder, and next to the program in its sandbox.
DATA = "data"

#: The file, in a web page's copy of an exercise, that says what a page lacks to check it.
LACKS = "lacks.txt"

#: Each run gets them anew, in memory (bytes).
MOST_DATA_BYTES = 64_000_000


def data_paths(exercise: Exercise) -> list[Path]:
    """Return the files in the exercise's folder `data`, without hidden ones. Raises `ExerciseError` for too much."""
    folder = exercise.folder / DATA
    files = [file for file in sorted(folder.rglob("*")) if file.is_file() and not file.is_symlink()]
    files = [file for file in files if not any(part.startswith(".") for part in file.relative_to(folder).parts)]
    if (size := sum(file.stat().st_size for file in files)) > MOST_DATA_BYTES:
        problem = f"its files have {size / 1e6:.0f} MB together"
        raise ExerciseError(folder, problem, f"Each run copies them: leave at most {MOST_DATA_BYTES / 1e6:.0f} MB.")
    return files


def data_files(exercise: Exercise) -> dict[str, bytes]:
    """Return the content of each file by its path next to the program, such as `data/map.png`."""
    return {file.relative_to(exercise.folder).as_posix(): file.read_bytes() for file in data_paths(exercise)}
