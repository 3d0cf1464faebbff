"""Who asks, and who presses the button. Each scenario is a fixture in checks.py and hidden_checks.py."""

from __future__ import annotations

from grader.scenario import Scenario, at
from grader.scenario.scenario import Content

SWITCH, STOP = "/switch_motors", "/emergency_stop"


def on(*seconds: float) -> tuple[Content, ...]:
    """Requests to switch the motors on."""
    return at(*seconds).call(SWITCH, data=True)


def off(*seconds: float) -> tuple[Content, ...]:
    """Requests to switch the motors off."""
    return at(*seconds).call(SWITCH, data=False)


def pressed(*seconds: float) -> tuple[Content, ...]:
    """The emergency stop is pressed."""
    return at(*seconds).publish(STOP, data=True)


def released(*seconds: float) -> tuple[Content, ...]:
    """The emergency stop is released."""
    return at(*seconds).publish(STOP, data=False)


def scenarios(seed: int) -> tuple[Scenario, ...]:
    """Every scenario. The first one must be passed by any node that works at all."""
    scripts = {
        "switching": ("on, off, and on again", (on(0.5, 1.5), off(1.0))),
        "already": ("on twice, then off twice", (on(0.5, 1.0), off(1.5, 2.0))),
        "off_first": ("off, although the motors are off", (off(0.5), on(1.0))),
        "emergency": ("an emergency stop while the motors are on", (on(0.5), pressed(1.0), on(1.5), off(2.0), on(2.5))),
        "released": ("the emergency stop is released again", (on(0.5), pressed(1.0), released(1.5), on(2.5))),
        "pressed_while_off": (
            "an emergency stop while the motors are off",
            (pressed(0.5), on(1.0), released(1.5), on(2.0)),
        ),
        "pressed_twice": (
            "pressed twice, released twice",
            (on(0.5), released(0.7), pressed(1.0, 1.2), on(1.4), released(1.6), on(1.8), released(2.0), off(2.2)),
        ),
        "many": ("twenty requests in one second", tuple((on(0.5 + n / 10), off(0.55 + n / 10)) for n in range(10))),
    }
    return tuple(
        Scenario(name, title, script, duration=3.0, rate=20.0, interrupt=name == "switching")
        for name, (title, script) in scripts.items()
    )
