"""The kinds of exercises that `spinbook new` makes: one Markdown file per kind, in the folder `kinds`.

The file's heading names the kind, and its first paragraph says for `spinbook new --help` what the node does. Each fence
with a title is a file of the author's exercise, or of its solutions, and a Jinja template: `{{ name }}` is the name of
the exercise. What all kinds share, such as `main()`, is a fence of shared/every_kind.md, and they include it.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from jinja2 import DictLoader, Environment, StrictUndefined
from markdown_it import MarkdownIt

_FOLDER = Path(__file__).parent / "kinds"
_SHARED = _FOLDER / "shared" / "every_kind.md"
_TITLE = re.compile(r'\w+ title="([^"]+)"')


@dataclass(frozen=True)
class ExerciseKind:
    """One kind of exercise; `source` is its file. Its first check is the one on which the others depend."""

    source: Path

    @property
    def name(self) -> str:
        """As in `--kind service-server`."""
        return self.source.stem

    @cached_property
    def summary(self) -> str:
        """What the node does, in a few words."""
        return self.source.read_text(encoding="utf-8").split("\n\n")[1].strip()

    def files(self, exercise: str, title: str) -> dict[Path, str]:
        """Return the files of an exercise of this kind, by their paths in a course."""
        parts = dict(_parts(self.source))
        templates = Environment(
            loader=DictLoader({**dict(_parts(_SHARED)), **parts}),
            undefined=StrictUndefined,
            trim_blocks=True,
            keep_trailing_newline=True,
        )
        names = {
            "name": exercise,
            "Name": _class_name(exercise, "".join(parts.values())),
            "words": exercise.replace("_", " "),
            "title": title,
        }
        return {_path(part, exercise): templates.get_template(part).render(names) for part in parts}


def kinds() -> tuple[ExerciseKind, ...]:
    """Return all kinds by their names; none in an installation without templates."""
    return tuple(ExerciseKind(source) for source in sorted(_FOLDER.glob("*.md")))


def _parts(source: Path) -> Iterator[tuple[str, str]]:
    """Yield the title and the content of each fence that has a title."""
    for token in MarkdownIt().parse(source.read_text(encoding="utf-8")):
        if token.type == "fence" and (title := _TITLE.fullmatch(token.info.strip())):
            yield title[1], token.content


def _path(part: str, exercise: str) -> Path:
    """Return a file's path in a course: exercises/task.md -> exercises/gripper_force/task.md."""
    folder, _, rest = part.partition("/")
    return Path(folder, exercise, rest)


def _class_name(exercise: str, sources: str) -> str:
    """Return the class for an exercise's name: gripper_force -> GripperForce.

    A class may not hide what a program imports: float64 -> Float64Node.
    """
    name = "".join(word.capitalize() for word in exercise.split("_"))
    return f"{name}Node" if re.search(rf"\b{name}\b", sources) else name
