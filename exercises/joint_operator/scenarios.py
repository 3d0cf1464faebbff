"""How the server behaves. Each scenario is a fixture in checks.py and hidden_checks.py."""

from __future__ import annotations

from grader.scenario import ActionServer, Scenario, aborts, at, never_ends, rejects, succeeds
from grader.scenario.scenario import Content

ACTION, TARGETS = "/move_joint", "/targets"


def target(position: float, *seconds: float) -> tuple[Content, ...]:
    """Somebody wants the joint to be at a position."""
    return at(*seconds).publish(TARGETS, data=position)


def moves(after: float, *positions: float, **more: object) -> object:
    """A goal that succeeds, with feedback at equal times on the way."""
    gap = after / (len(positions) + 1)
    feedback = {gap * (n + 1): {"position": position} for n, position in enumerate(positions)}
    return succeeds(after=after, result={"position": 0.0}, feedback=feedback, **more)


def scenarios(seed: int) -> tuple[Scenario, ...]:
    """Every scenario. The first one must be passed by any node that works at all."""
    one = target(0.8, 0.53)
    three = (one, target(0.3, 0.83), target(1.2, 1.13))
    good, endless = moves(1.0, 0.2, 0.5), never_ends(cancel_takes=0.5)
    scripts = {
        "succeeds": ("one target, and a server that moves for 1.2 s", 2.5, one, (moves(1.2, 0.217, 0.43, 0.618),), {}),
        "several": ("three targets, one soon after the other", 6.0, three, (good, moves(1.5, 0.7, 0.4), good), {}),
        "again": (
            "the same target twice, 0.0, and one below zero",
            6.0,
            (target(0.8, 0.53, 0.83), target(0.0, 1.13), target(-0.4, 1.33)),
            (good,),
            {},
        ),
        "rejects": ("the first goal is rejected after 1 s", 5.5, three, (rejects(answers_after=1.0), good), {}),
        "aborts": ("the first goal is aborted", 5.0, three, (aborts(after=0.7), good), {}),
        "answers_late": ("the server takes 1.5 s to accept", 4.0, one, (moves(1.0, 0.5, answers_after=1.5),), {}),
        "appears": (
            # More targets than a queue holds: a node that waits for the server in a callback loses some.
            "fourteen targets, and a server that appears after 2 s",
            12.5,
            tuple(target((n + 1) / 10, 0.53 + n / 10) for n in range(14)),
            (moves(0.1, 0.2),),
            {"appears": 2.02},
        ),
        "never_ends": ("the first and the third goal never end", 14.0, three, (endless, good, endless), {}),
        "slow": ("a goal that takes 4.5 s", 6.0, one, (moves(4.5, 0.2, 0.5),), {}),
        "late_and_slow": (
            "accepted after 2 s, and 4 s on its way",
            7.5,
            one,
            (moves(4.0, 0.2, answers_after=2.0),),
            {},
        ),
        "refuses_to_cancel": (
            "7 s on its way, and no way to cancel",
            10.0,
            three[:2],
            (moves(7.0, 0.2, 0.2, 0.6, cancel="refuse"), good),
            {},
        ),
        "ignores_the_cancel": (
            "accepts the cancel request, but succeeds anyway",
            9.0,
            three[:2],
            (moves(6.0, 0.2, cancel="ignore"), good),
            {},
        ),
        "aborts_late": (
            "aborted after 6 s, whatever is asked",
            9.0,
            three[:2],
            (aborts(after=6.0, cancel="refuse"), good),
            {},
        ),
    }
    return tuple(
        Scenario(
            name,
            title,
            script,
            duration=duration,
            rate=10.0,
            servers=(ActionServer(ACTION, goals=goals, **when),),
            interrupt=name == "succeeds",
        )
        for name, (title, duration, script, goals, when) in scripts.items()
    )
