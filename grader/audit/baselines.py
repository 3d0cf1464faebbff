"""Programs that can't be worth much: they are made from an exercise's interface alone, and do no work."""

from __future__ import annotations

import itertools
import json
from collections import Counter
from pathlib import Path
from typing import get_args

from grader.exercise.exercise import Exercise, Qos, Role
from grader.recording.recording import Recording
from grader.scenario.times import SECOND

#: What the programs publish and respond: what arrived, or the same with other numbers and texts.
STYLES = ("echo", "zeros", "a constant", "random values")

#: A topic counts as periodic if the solution publishes at least this often, at gaps of which most are equal.
_OFTEN = 5


def programs(exercise: Exercise, reference: Recording) -> dict[str, str]:
    """Return the source of each baseline by its name.

    `reference` is the solution's recording of the first scenario. A topic on which the solution publishes regularly
    gets a timer with its period; everything else is published when a message arrives, or once at the start.
    """
    program = Path(__file__).with_name("baseline_program.py").read_text(encoding="utf-8")
    sources = {}
    for style in STYLES:
        settings = json.dumps(_settings(exercise, reference, style))
        sources[style] = program.replace('json.loads("{}")', f"json.loads({settings!r})")
    return sources


def _settings(exercise: Exercise, reference: Recording, style: str) -> dict[str, object]:
    texts = [p.default for p in exercise.parameters if isinstance(p.default, str)]
    return {
        "style": style,
        "node": exercise.node_name,
        "text": texts[0] if texts else "a",
        "parameters": [(p.name, p.default) for p in exercise.parameters if p.default is not None],
        "publish": [(t.name, t.type, _qos(t.qos), _period(reference, t.name)) for t in exercise.outputs],
        "subscribe": [(t.name, t.type, _qos(t.qos)) for t in exercise.inputs],
        **{role: [(end.name, end.type) for end in exercise.of_role(role)] for role in get_args(Role)},
    }


def _qos(qos: Qos) -> tuple[str, str, int]:
    return qos.reliability, qos.durability, qos.depth


def _period(reference: Recording, topic: str) -> float | None:
    """Return the period (s) at which the solution publishes on `topic`; None if it is not regular, or only answers."""
    times = [message.at_ns for message in reference.received if message.topic == topic and not message.subscriber]
    gaps = Counter(round((b - a) / SECOND, 3) for a, b in itertools.pairwise(times))
    answered = {message.at_ns for message in reference.sent} & set(times)
    if len(times) < _OFTEN or len(answered) > len(times) / 2:
        return None
    period, often = gaps.most_common(1)[0]
    return period if period and often > sum(gaps.values()) / 2 else None
