"""How the calibration service behaves. Each scenario is a fixture in checks.py and hidden_checks.py."""

from __future__ import annotations

import math

from grader.scenario import Scenario, Server, at, no_reply, reply
from grader.scenario.scenario import Content

SERVICE, JOINTS = "/calibrate_joint", "/calibrate"
ELBOW, ROLL, PITCH = "left_elbow", "left_shoulder_roll", "left_shoulder_pitch"


def wanted(joint: str, *seconds: float) -> tuple[Content, ...]:
    """Somebody wants a joint to be calibrated."""
    return at(*seconds).publish(JOINTS, data=joint)


def server(*replies: object, **when: float) -> tuple[Server, ...]:
    """The service, which answers one request after another."""
    return (Server(SERVICE, replies=replies, **when),)


def found(offset: float, after: float = 0.0) -> object:
    """A calibration that succeeds."""
    return reply(after, success=True, offset=offset, message="calibrated")


def failed(after: float = 0.0) -> object:
    """A calibration that fails."""
    return reply(after, success=False, offset=0.7, message="the joint is blocked")


def scenarios(seed: int) -> tuple[Scenario, ...]:
    """Every scenario. The first one must be passed by any node that works at all."""
    one, three = wanted(ELBOW, 0.55), (wanted(ELBOW, 0.55), wanted(ROLL, 0.65), wanted(PITCH, 0.75))
    broken = (found(math.nan), found(math.inf), found(0.02))
    return (
        Scenario(
            "one",
            "one joint, and an answer after 0.8 s",
            one,
            duration=2.5,
            rate=20.0,
            servers=server(found(-0.0314, 0.8)),
            interrupt=True,
        ),
        Scenario("slow", "an answer after 4.5 s", one, duration=6.0, rate=20.0, servers=server(found(0.04, 4.5))),
        Scenario(
            "several",
            "five joints at the same time, answered in another order",
            (*three, wanted("Neck", 0.85), wanted("right_elbow", 0.95)),
            duration=4.5,
            rate=20.0,
            servers=server(found(0.01, 0.9), found(0.02, 0.8), found(0.03, 0.5), found(0.04, 0.6), found(0.05, 0.4)),
        ),
        Scenario(
            "again",
            "the same joint twice, and an offset of 0.0",
            wanted(ELBOW, 0.55, 0.95),
            duration=3.0,
            rate=20.0,
            servers=server(found(0.01, 1.2), found(0.0, 1.2)),
        ),
        Scenario(
            "failing",
            "the first calibration fails",
            three,
            duration=3.0,
            rate=20.0,
            servers=server(failed(0.5), found(0.02, 0.5)),
        ),
        Scenario("not_finite", "offsets that are no numbers", three, duration=2.5, rate=20.0, servers=server(*broken)),
        Scenario(
            "appears",
            "the service appears after 2 s",
            three,
            duration=4.0,
            rate=20.0,
            servers=server(found(0.01, 0.5), found(0.02, 0.5), found(0.03, 0.5), appears=2.02),
        ),
        Scenario(
            "appears_very_late",
            "the service appears after 6 s",
            wanted(ELBOW, 0.55),
            duration=7.5,
            rate=20.0,
            servers=server(found(0.04, 0.5), appears=6.02),
        ),
        Scenario(
            "never",
            "the first request is never answered",
            three,
            duration=7.5,
            rate=20.0,
            servers=server(no_reply(), found(0.02, 0.5)),
        ),
        Scenario(
            "too_late",
            "an answer after 5.6 s, to a joint that is wanted again meanwhile",
            (*three, wanted(ELBOW, 5.9)),
            duration=7.5,
            rate=20.0,
            servers=server(found(0.01, 5.6), found(0.02, 0.5)),
        ),
        Scenario("absent", "the service never appears", three, duration=2.0, rate=20.0),
    )
