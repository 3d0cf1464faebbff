"""A class of any size, made from the right solutions, the usual mistakes, hostile programs and odd files.

The same size and seed make the same class. With each submission goes what its grade must be.
"""

from __future__ import annotations

import random
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import cycle, islice
from pathlib import Path
from typing import Any

from variants import as_notebook, as_upload, reworded

from grader.exercise import load
from grader.exercise.mistakes import Mistake, mistakes_of

ROOT = Path(__file__).parents[2]
EXERCISE = "joint_velocity"
FILE = f"{EXERCISE}.py"
SOLUTIONS = ROOT / "solutions" / EXERCISE
HOSTILE = ROOT / "tests" / "grader" / "hostile"

sys.path.append(str(HOSTILE))
from odd_files import ODD_FILES, OddFile  # noqa: E402
from submissions import SUBMISSIONS, HostileProgram  # noqa: E402

#: Of a class this share hands in mistakes, hostile programs and files that are odd as files; the rest is right.
MISTAKEN, ATTACKING, ODD = 0.30, 0.12, 0.03

#: An empty folder hands in nothing, the link needs a file next to the student's folder, the cells are 100 MB to write.
LEFT_OUT = {"folder", "symlink_to_a_secret", "million_cells"}

FIRST = (
    *("Ada", "Ali", "Amara", "Ana", "Ben", "Chen", "Dina", "Elif", "Emil", "Femi", "Grace", "Hana", "Ines", "Ivan"),
    *("Jon", "Kofi", "Lena", "Leo", "Mai", "Mira", "Nils", "Nora", "Omar", "Priya"),
)
LAST = (
    *("Abe", "Berg", "Costa", "Diaz", "Eriksen", "Fischer", "Gupta", "Haddad", "Ito", "Jansen", "Kaya", "Lund"),
    *("Mbeki", "Novak", "Okoro", "Popov", "Rossi", "Sato"),
)


@dataclass(frozen=True)
class Expected:
    """What a grade must be. `fails` are exactly the checks that fail, where that is known; the rest is as in
    tests/grader/hostile/submissions.md.
    """

    outcomes: tuple[str, ...] = ("graded",)
    score: str = "full"
    fails: frozenset[str] | None = None
    words: tuple[str, ...] = ()
    never: tuple[str, ...] = ()


@dataclass(frozen=True)
class Handed:
    """One student's submission: whose, of which kind, made from what, and how it is written into a folder."""

    student: str
    kind: str
    origin: str
    expected: Expected
    write: Callable[[Path], object]


def the_class(count: int, seed: int, hostile: bool = True, exercise: str = EXERCISE) -> list[Handed]:
    """`count` students in alphabetical order, who hand in as a real class does; or only what is meant well.

    Hostile programs and odd files are those of joint_velocity: other exercises get right ones and mistakes only.
    """
    chance = random.Random(seed)
    hostile = hostile and exercise == EXERCISE
    attacking, odd = (round(ATTACKING * count), round(ODD * count)) if hostile else (0, 0)
    solutions = SOLUTIONS.parent / exercise
    mistaken = round(MISTAKEN * count)
    origins = [
        *islice(cycle(_attacks(chance)), attacking),
        *islice(cycle(_odd(chance)), odd),
        *islice(cycle(_shuffled(mistakes_of(load(ROOT / "exercises" / exercise)), chance)), mistaken),
        *islice(cycle([solutions / "solution.py", *sorted((solutions / "right").glob("*.py"))]), count),
    ][:count]
    chance.shuffle(origins)
    pairs = zip(_names(count, chance), origins, strict=True)
    return [_handed(name, origin, chance, exercise) for name, origin in pairs]


def course_class(exercises: Sequence[str], count: int, seed: int) -> dict[str, list[Handed]]:
    """The same `count` students for each exercise; after the first exercise, each is left out by one of twelve."""
    names = _names(count, random.Random(seed))
    made: dict[str, list[Handed]] = {}
    for number, exercise in enumerate(exercises):
        handed = the_class(count, seed + number, exercise=exercise)
        renamed = [replace(one, student=name) for one, name in zip(handed, names, strict=True)]
        made[exercise] = [one for i, one in enumerate(renamed) if not number or (i + number) % 12]
    return made


def write(made: list[Handed], folder: Path) -> None:
    """Write the class's submissions, a folder a student."""
    for handed in made:
        (folder / handed.student).mkdir(parents=True)
        handed.write(folder / handed.student)


def _names(count: int, chance: random.Random) -> list[str]:
    every = [f"{first} {last}" for last in LAST for first in FIRST]
    while len(every) < count:
        every += [f"{name} {len(every)}" for name in every]
    return sorted(chance.sample(every, k=count))


def _shuffled(origins: Sequence[Any], chance: random.Random) -> list[Any]:
    return chance.sample(origins, k=len(origins))


def _attacks(chance: random.Random) -> list[HostileProgram]:
    return _shuffled(list(SUBMISSIONS.values()), chance)


def _odd(chance: random.Random) -> list[OddFile]:
    return _shuffled([odd for odd in ODD_FILES if odd.name not in LEFT_OUT], chance)


def _handed(
    student: str, origin: Path | OddFile | HostileProgram | Mistake, chance: random.Random, exercise: str
) -> Handed:
    if isinstance(origin, OddFile):
        return Handed(
            student, "odd file", origin.name, Expected(origin.outcome, origin.score, words=(origin.words,)), origin.make
        )
    if isinstance(origin, HostileProgram):
        expected = Expected(origin.outcome, origin.score, None, origin.words, origin.never)
        return Handed(student, "hostile", origin.name, expected, lambda f: (f / FILE).write_text(origin.source))
    if isinstance(origin, Mistake):
        # A mistake may end its program: what was recorded until then is judged.
        fails = Expected(("graded", "crashed"), "less", frozenset(origin.caught_by))
        return Handed(student, "mistake", origin.name, fails, _writer(origin.source, student, chance, exercise))
    write = _writer(origin.read_text(encoding="utf-8"), student, chance, exercise)
    return Handed(student, "right", origin.stem, Expected(fails=frozenset()), write)


def _writer(source: str, student: str, chance: random.Random, exercise: str) -> Callable[[Path], object]:
    """Return what writes the program, in the student's own words, into a folder."""
    name, text = _packed(reworded(source, student, chance), chance, exercise)
    return lambda folder: (folder / name).write_bytes(text)


def _packed(source: str, chance: random.Random, exercise: str) -> tuple[str, bytes]:
    """As a file, or now and then as a notebook, or as the upload that `spinbook submit` writes."""
    kind = chance.choices(("py", "ipynb", "zip"), (7, 2, 1))[0]
    if kind == "ipynb":
        return "notebook.ipynb", as_notebook(source, exercise).encode()
    if kind == "zip":
        return f"{exercise}.zip", as_upload(source, f"{exercise}.py", exercise)
    return f"{exercise}.py", source.encode()
