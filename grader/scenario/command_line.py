"""What follows a program's name on its command line in a scenario."""

from __future__ import annotations

import json
from typing import Any

from grader.scenario.scenario import Scenario

#: How every program is started.
ARGUMENTS = ("--ros-args", "-p", "use_sim_time:=true")


def arguments(scenario: Scenario) -> tuple[str, ...]:
    """What follows the program's name on its command line in a scenario."""
    found = [*scenario.arguments, *ARGUMENTS]
    for name, value in scenario.parameters.items():
        found += ["-p", f"{name}:={_yaml(value)}"]
    for name, to in scenario.remappings.items():
        found += ["-r", f"{name}:={to}"]
    if scenario.namespace:
        found += ["-r", f"__ns:={scenario.namespace}"]
    return tuple(found)


def _yaml(value: Any) -> str:
    """A parameter's value on a command line, such as `2.0`, `true` or `["a", "b"]`."""
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(_yaml(one) for one in value)}]"
    if isinstance(value, float):
        text = repr(value)
        special = {"nan": ".nan", "inf": ".inf", "-inf": "-.inf"}
        # A number with an exponent needs a point to be one in YAML 1.1.
        return special.get(text, text if "." in text or "e" not in text else text.replace("e", ".0e"))
    return json.dumps(value)
