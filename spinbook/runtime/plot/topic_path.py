"""rqt_plot's way to name what to draw: a topic, a field of it, an index, in one path."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass

_STEP = re.compile(r"([A-Za-z]\w*)((?:\[\d+\])*)")


@dataclass(frozen=True)
class TopicPath:
    """What to draw of a topic: `steps` lead from the message to a value, names and indices in order."""

    topic: str
    steps: tuple[str | int, ...]

    @property
    def field(self) -> str:
        """The steps as they are written: `position[0]`, `linear/x`."""
        text = ""
        for step in self.steps:
            text += f"[{step}]" if isinstance(step, int) else f"/{step}"
        return text.lstrip("/")


def resolve(path: str, topics: Iterable[str]) -> TopicPath | None:
    """Split a path into one of these topics and a field. The longest topic that fits is meant, as in rqt_plot.

    None where no topic fits. Raises ValueError where the rest is not a field.

    >>> resolve('/joint_commands/position[0]', ['/joint_commands'])
    TopicPath(topic='/joint_commands', steps=('position', 0))
    """
    full = path if path.startswith("/") else f"/{path}"
    fitting = [t for t in topics if full == t or (full.startswith(t) and full[len(t)] in "/.[")]
    if not fitting:
        return None
    topic = max(fitting, key=len)
    return TopicPath(topic, _steps(full[len(topic) :].lstrip("/."), path))


def _steps(rest: str, path: str) -> tuple[str | int, ...]:
    steps: list[str | int] = []
    for part in re.split(r"[/.]", rest) if rest else []:
        match = _STEP.fullmatch(part)
        if not match:
            raise ValueError(f"`{part}` in `{path}` is no field: write for example /joint_commands/position[0].")
        steps.append(match.group(1))
        steps += [int(index) for index in re.findall(r"\d+", match.group(2))]
    return tuple(steps)
