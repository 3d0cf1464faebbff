"""The arguments of a program in a scenario."""

from __future__ import annotations

import json
from typing import Any

from grader.scenario.scenario import Scenario

#: The arguments of every program.
ARGUMENTS = ("--ros-args", "-p", "use_sim_time:=true")


def arguments(scenario: Scenario) -> tuple[str, ...]:
    """Return the arguments that follow the program's name on its command line in a scenario."""
    found = [*scenario.arguments, *ARGUMENTS]
    for name, value in scenario.parameters.items():
        found += ["-p", f"{name}:={_yaml(value)}"]
    for name, to in scenario.remappings.items():
        found += ["-r", f"{name}:={to}"]
    if scenario.namespace:
        found += ["-r", f"__ns:={scenario.namespace}"]
    return tuple(found)


def _yaml(value: Any) -> str:
    """Return a parameter's value for the command line, such as `2.0`, `true` or `["a", "b"]`."""
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(_yaml(one) for one in value)}]"
    if isinstance(value, float):
        text = repr(value)
        special = {"nan": ".nan", "inf": ".inf", "-inf": "-.inf"}
        # In YAML 1.1, a number with an exponent also needs a decimal point.
        return special.get(text, text if "." in text or "e" not in text else text.replace("e", ".0e"))
    return json.dumps(value)
