"""Names of topics, services and actions that a check may ask for, as the exercise and the solution's run have them."""

from __future__ import annotations

from grader.exercise.exercise import Exercise
from grader.recording.recording import Recording
from groundwork.words import did_you_mean

#: Topics that every node has without creating them.
OF_EVERY_NODE = ("/clock", "/rosout", "/parameter_events")


def names_of(exercise: Exercise, reference: Recording) -> frozenset[str]:
    """Return every name that the exercise declares or that occurs in the run with the solution."""
    names = {*OF_EVERY_NODE, *(topic.name for topic in exercise.topics), *(end.name for end in exercise.endpoints)}
    names |= {end.topic for end in reference.end_points}
    names |= {message.topic for message in (*reference.sent, *reference.received)}
    return frozenset(names | {call.service for call in reference.calls} | {goal.action for goal in reference.goals})


def not_existing(name: str, word: str, names: frozenset[str], scenario: str) -> str:
    """Return what is wrong with a name, a `word` such as "topic", that is none of `names`; "" if it is right.

    A program in a namespace has the declared names behind those of its namespace.
    """
    if name in names or any(name.endswith(f"/{known.lstrip('/')}") for known in names if known.strip("/")):
        return ""
    others = sorted(names - {*OF_EVERY_NODE})
    fix = did_you_mean(name, others, f"There are: {', '.join(others) or 'none'}.")
    return f"there is no {word} {name} in exercise.toml, nor in the scenario {scenario}. {fix}"
