"""Scenarios: what happens around a student's program, declared in a few lines."""

from grader.exercise.exercise import Qos
from grader.scenario.models import JointChain, Turtle
from grader.scenario.physics import MuJoCo
from grader.scenario.scenario import Companion, Message, Program, Scenario
from grader.scenario.servers import ActionServer, Server, aborts, never_ends, no_reply, rejects, reply, succeeds
from grader.scenario.steps import at, before_start
from grader.scenario.times import every, uneven
from grader.scenario.world import World

__all__ = [
    "ActionServer",
    "Companion",
    "JointChain",
    "Message",
    "MuJoCo",
    "Program",
    "Qos",
    "Scenario",
    "Server",
    "Turtle",
    "World",
    "aborts",
    "at",
    "before_start",
    "every",
    "never_ends",
    "no_reply",
    "rejects",
    "reply",
    "succeeds",
    "uneven",
]
