"""How a run ended, as the student reads it: with advice on the error, if there is any."""

from __future__ import annotations

import difflib
import re
import sys
from collections.abc import Mapping
from importlib.util import find_spec

from grader.exercise.exercise import Exercise
from grader.recording.recording import Ending
from grader.submission.python_code import MATPLOTLIB, imported
from grader.submission.python_version import newer_name

#: What the sandbox has besides Python itself, as a student would import it.
AVAILABLE = "rclpy, tf2, the standard ROS 2 messages (std_msgs, geometry_msgs, sensor_msgs and so on), numpy"

MISSING = re.compile(r"ModuleNotFoundError: No module named '((?P<top>[^'.]+)[^']*)'")
NO_NAME = re.compile(r"ImportError: cannot import name '([^']+)' from '([^']+)'")

#: An error to which `grader.runner.program_end` has added advice, behind the line that it quotes.
ADVISED = re.compile(r" in line \d+[^`]*: `.*`\. \S")

#: Modules that notebooks have or that students install, and so their programs have, but not what grades them.
OF_NOTEBOOKS = {*MATPLOTLIB, "PIL", "IPython", "nbformat"}

ADVICE = (
    (r"IndentationError|TabError", "Compare the indentation of this line with the lines around it."),
    (r"(?i)SyntaxError: (?:.*non-utf-8|\(unicode)", "Save the file as UTF-8."),
    (
        r"SyntaxError: invalid (?:non-printable )?character",
        "Type this character again: copied text may have other quotes, dashes or spaces than Python's.",
    ),
    (r'SyntaxError: [^`]*`.*"<[^"]*="\w', "Inside \"…\" a text can't have the same quotes: write it as '…'."),
    (r"outside async function", "A function in which you write await begins with async def."),
    (r"SyntaxError: '\w+' outside", "Indent this line as the other lines of its function or loop."),
    (r"SyntaxError: invalid syntax(?!\. )", "Python can't read this line. Look at the end of the line before it, too."),
    (r"Address family not", "A node has no network while it is graded and needs none: it communicates over ROS 2."),
    (r"NameError", "Is the name spelled as in its definition, and imported or defined before this line?"),
    (r"ZeroDivisionError", "When is the number that this line divides by zero?"),
    (r"KeyError|IndexError", "When is this key or index missing?"),
    (
        r"(?:Attribute|Type)Error.*\bNoneType",
        "Something in this line is None: what fills it, and has that happened by now?",
    ),
)


#: What beginners import from rclpy itself, and the module that has it.
OF_RCLPY = {
    "Node": "rclpy.node",
    "ActionServer": "rclpy.action",
    "ActionClient": "rclpy.action",
    "Duration": "rclpy.duration",
}

#: Modules of ROS 1, and what ROS 2 has for them.
ROS_1 = {"rospy": "rclpy", "roslib": "rclpy", "actionlib": "rclpy.action", "tf": "tf2_ros"}


def _instead(module: str, exercise: Exercise, message: str) -> str:
    """Return what to import in place of a module that is not available; `message` quotes the line that does."""
    names = [module, *re.findall(r"\w+", message.rpartition(" import ")[2])]
    top = module.partition(".")[0]
    if top in ROS_1:
        return (
            f"{top} belongs to ROS 1. The course uses ROS 2, where it is {ROS_1[top]}, and other calls differ, too: "
            "begin with a program of the chapter."
        )
    types = [*(topic.type for topic in exercise.topics), *(end.type for end in exercise.endpoints)]
    own = {name.partition("/")[0]: name for name in types}
    sought = module.partition(".")[2]
    is_class = any(name.endswith(f"/{module}") for name in types)
    if is_class or (top in own and sought):
        best = max(types, key=lambda name: (name.split("/")[2] in names, f"/{sought}/" in name, top in name))
        package, kind, name = best.split("/")
        why = f"{module} is a class of {package}.{kind}" if is_class else f"{top} has no module {sought}"
        return f"{why}: write from {package}.{kind} import {name}."
    close = difflib.get_close_matches(top, [*exercise.packages, *own], n=1)
    meant = f" Is it a misspelling of {close[0]}?" if close else ""
    available = ", ".join([AVAILABLE, *exercise.packages])
    return f"The module {module} is not available here. Available are Python's own modules, {available}.{meant}"


def lacks_a_notebooks_module(ending: Ending, sources: Mapping[str, str]) -> str:
    """Return the module of `OF_NOTEBOOKS` for whose lack a program ended here, otherwise an empty text.

    A program that does not import the module only pretends, to get no zero.
    """
    missing = MISSING.search(ending.message)
    if not missing or missing["top"] not in OF_NOTEBOOKS or find_spec(missing["top"]):
        return ""
    imports = {name.partition(".")[0] for source in sources.values() for name in imported(source)}
    return missing["top"] if missing["top"] in imports else ""


def message_of(ending: Ending, exercise: Exercise) -> str:
    """Return how a run ended, with advice if there is any; empty when all went well.

    Advice on the very text of an error, which the recording has, is more specific than the exercise's on a kind of
    exception; that is more specific than the advice that fits every program.
    """
    message = ending.message
    is_advised = bool(ADVISED.search(message))
    for exception, advice in exercise.advice.items():
        if re.search(rf"\b{re.escape(exception)}\b", message) and not is_advised:
            return f"{message} {advice}"
    if newer := newer_name(message):
        return f"{message} {newer}"
    if (missing := MISSING.search(message)) and not is_advised and missing["top"] not in sys.stdlib_module_names:
        return f"{message} {_instead(missing[1], exercise, message)}"
    if no_name := NO_NAME.search(message):
        name = no_name[1][:1].upper() + no_name[1][1:]
        if place := OF_RCLPY.get(name) if no_name[2] == "rclpy" else "":
            return f"{message} {name} is in {place}: write from {place} import {name}."
        case = f"It may have {name}: capital letters count." if name != no_name[1] else "Is the name spelled right?"
        return f"{message} The module {no_name[2]} has no {no_name[1]}. {case}"
    for pattern, advice in ADVICE:
        if re.search(pattern, message) and not is_advised:
            return f"{message} {advice}"
    return message
