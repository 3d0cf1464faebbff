"""What a student is told about a run that did not come to its end."""

from __future__ import annotations

import re

from grader.recording import Ending

#: What the sandbox has beside Python itself, as a student would import it.
AVAILABLE = "rclpy, the standard ROS 2 messages (std_msgs, geometry_msgs, sensor_msgs and so on) and numpy"

MISSING = re.compile(r"ModuleNotFoundError: No module named '([^']+)'")
NO_NAME = re.compile(r"ImportError: cannot import name '([^']+)' from '([^']+)'")

ADVICE = (
    (
        re.compile(r"IndentationError|TabError"),
        "Compare the spaces at the beginning of this line with its neighbours'.",
    ),
    (re.compile(r"SyntaxError: .*non-utf-8|SyntaxError: \(unicode", re.IGNORECASE), "Save the file as UTF-8."),
    (re.compile(r"SyntaxError"), "Python can't read this line; look at the end of the line before it, too."),
    (
        re.compile(r"Address family not supported"),
        "A node has no network while it is graded, and needs none: it talks over ROS 2 alone.",
    ),
    (re.compile(r"NameError"), "Is the name spelled as where it was made, and made before it is used?"),
    (re.compile(r"ZeroDivisionError"), "What if two messages have the same stamp?"),
    (re.compile(r"KeyError|IndexError"), "What if a joint is in this message and was not in the one before?"),
    (re.compile(r"AttributeError: 'NoneType'"), "What does it hold before the first message has arrived?"),
)


def message_of(ending: Ending) -> str:
    """The story of an ending, with advice where there is one; empty when all went well."""
    story = ending.story
    if missing := MISSING.search(story):
        return f"{story} There is no module {missing[1]} here. There are Python's own modules, {AVAILABLE}."
    if no_name := NO_NAME.search(story):
        return f"{story} The module {no_name[2]} has no {no_name[1]}. Is the name spelled right?"
    for pattern, advice in ADVICE:
        if pattern.search(story):
            return f"{story} {advice}"
    return story
