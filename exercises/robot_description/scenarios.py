"""Who subscribes when, and which texts are set. Each scenario is a fixture in checks.py and hidden_checks.py."""

from __future__ import annotations

from grader.scenario import Scenario, at
from grader.scenario.scenario import Content

TOPIC = NAME = "/robot_description"
PARAMETER = "robot_description"

#: A text with line breaks, an empty line, spaces, a tab, quotes and letters that are not English.
ARM = """<?xml version="1.0"?>
<robot name="right-arm">
  <link name="upper_arm"/>
  <!-- Länge: 0.3 m -->

  <link name="forearm"/>\t
  <joint name='elbow' type="revolute">
    <parent link="upper_arm"/>
    <child link="forearm"/>
    <origin xyz="0 0 -0.3"/>
  </joint>
</robot>
"""
LEG = '<robot name="leg"><link name="shin"/></robot>'
CALF = f"{LEG}\n"  # the same but for a line break
CENTIPEDE = "".join(("<robot>", *(f'<link name="leg_{n}"/>' for n in range(500)), "</robot>"))
NOT_XML = ("", "robot", "<robot", '<robot name="leg">')
ANOTHER_ROOT = ("<robots/>", "<my_robot/>", "<ROBOT/>", "<urdf/>", "<model><robot/></model>")


def late(*seconds: float) -> tuple[Content, ...]:
    """Subscribers that join late, called after the time at which they do."""
    return tuple(
        at(second).subscribe(TOPIC, name=f"late at {second:g} s", durability="transient_local") for second in seconds
    )


def written(text: object, *seconds: float) -> tuple[Content, ...]:
    """Somebody sets the description."""
    return at(*seconds).set_parameter(PARAMETER, text)


def scenarios(seed: int) -> tuple[Scenario, ...]:
    """Every scenario. The first one must be passed by any node that works at all."""
    read = at(2.3).get_parameter(PARAMETER)
    refused = tuple(written(text, 0.5 + n / 6) for n, text in enumerate(NOT_XML + ANOTHER_ROOT))
    scripts = {
        "late": ("somebody subscribes late", (late(1.0, 2.0),), {}),
        "started": ("started with another description", (late(1.0), read), {PARAMETER: ARM}),
        "changed": (
            "the description changes twice",
            (written(ARM, 0.55), written(LEG, 1.25), late(0.8, 1.6), read),
            {},
        ),
        "little": (
            "a text that differs in a line break only, one that was there before, a short one and a long one",
            tuple(written(text, 0.5 + 0.4 * n) for n, text in enumerate((LEG, CALF, LEG, "<robot/>", CENTIPEDE))),
            {},
        ),
        "same": ("the description is set to what it is", (written(LEG, 0.5, 1.0, 1.5), late(2.0)), {}),
        "refused": ("texts that describe no robot", (refused, late(2.0), read), {}),
        "after_refusal": (
            "a bad text, then a good one",
            (written("<robot", 0.5), written(ARM, 1.0), late(2.0), read),
            {},
        ),
    }
    return tuple(
        Scenario(name, title, script, duration=2.5, rate=20.0, parameters=parameters, interrupt=name == "late")
        for name, (title, script, parameters) in scripts.items()
    )
