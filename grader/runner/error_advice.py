"""Advice on an error that ended a program or a callback, if the error itself says little to a beginner.

The texts of errors are those of rclpy 7.1 and of CPython 3.10 to 3.14.
"""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Callable, Mapping

from grader.recording.types import message_class
from grader.runner.error_texts import advice_on_text
from grader.runner.node_attributes import advice_on_node_attribute
from grader.runner.tracebacks import LastError
from groundwork.words import beyond_ascii, similar

_RESULT = "An action's execute callback has to return a Result, such as `return {action}.Result()`."

#: Packages whose messages' fields are named. What a student's file imports is not imported otherwise.
_PACKAGES = ("std_msgs", "std_srvs", "geometry_msgs", "sensor_msgs", "nav_msgs", "turtlesim", "builtin_interfaces")

#: Fields of common messages that are messages themselves, and what these have.
_PARTS = {
    "stamp": ("sec", "nanosec"),
    "header": ("stamp", "frame_id"),
    "linear": ("x", "y", "z"),
    "angular": ("x", "y", "z"),
    "position": ("x", "y", "z"),
    "orientation": ("x", "y", "z", "w"),
    "pose": ("position", "orientation"),
}


def advice_on(last: LastError, sources: Mapping[str, str]) -> str:
    """Return what to do about an error, in one to three sentences; "" if the error says enough."""
    advisers: tuple[Callable[[LastError, Mapping[str, str]], str], ...] = (
        _of_newer_ros,
        _of_an_invalid_name,
        advice_on_node_attribute,
        _before_init,
        _of_a_callback,
        _of_a_field,
        _of_an_attribute,
        _of_a_name,
        advice_on_text,
        _without_text,
        _of_its_own,
    )
    return next((advice for adviser in advisers if (advice := adviser(last, sources))), "")


def result_advice(action: str) -> str:
    """Return what an execute callback of this action has to return."""
    return _RESULT.format(action=action)


def _of_newer_ros(last: LastError, sources: Mapping[str, str]) -> str:
    """Explain `with rclpy.init()`, which newer distributions of ROS 2 have, since Kilted."""
    if "rclpy.init" not in last.text or not re.search(r"context manager protocol|__enter__", last.error):
        return ""
    here = os.environ.get("ROS_DISTRO", "jazzy").capitalize()
    return (
        f"This is ROS 2 {here}, in which rclpy.init() can't follow `with`, as in newer versions. Write rclpy.init() on "
        "a line of its own, and call rclpy.try_shutdown() at the end."
    )


def _of_an_invalid_name(last: LastError, sources: Mapping[str, str]) -> str:
    """Name the character of a name that can't be seen, or that looks like another one."""
    if not re.match(r"[\w.]*Invalid\w*NameException", last.error):
        return ""
    return beyond_ascii(last.text.partition("#")[0], "no name may have: type that part again")


def _before_init(last: LastError, sources: Mapping[str, str]) -> str:
    """Explain what rclpy misses in a Node whose own __init__ was not called, or is called only later."""
    missing = re.search(r"AttributeError: '(\w+)' object has no attribute '_\w+'", last.error)
    if last.raised_there or not missing:
        return ""
    own = re.search(rf"^[ \t]*class {missing[1]}\(.*Node\b", sources.get(last.file, ""), re.MULTILINE)
    return "Begin __init__ with super().__init__('name'): that makes the node." if own else ""


def _of_a_callback(last: LastError, sources: Mapping[str, str]) -> str:
    """Explain an error that rclpy raises far from the line which caused it."""
    error, block = last.error, last.traceback
    if called := _CALLED.search(last.text) if "required positional" in error else _CALLED_WITH.search(block):
        return f"Give {called[1]} without parentheses: with them, it is called at once."
    if last.raised_there:
        return ""
    if re.search(r"takes \d+ positional argument|missing \d+ required positional", error):
        return _ARGUMENTS
    if "'NoneType' object is not callable" in error:
        return (
            "A callback is None. Give the method itself, such as self.on_timer: with parentheses, it is called at once."
        )
    if error == "TypeError" and ", in send_response" in block:
        return "A service's callback has to return the response: end each way through it with `return response`."
    if ", in publish_feedback" in block:
        return f"publish_feedback() takes a whole message: {_action(sources)}.Feedback(…), with the value in its field."
    if ", in send_goal" in block:
        return f"A goal is a whole message: {_action(sources)}.Goal(…), with the value in its field."
    if ", in call_async" in block or ", in call\n" in block:
        return "A request is a whole message of the service's type: Type.Request(…), with the values in its fields."
    if ", in _execute_goal" in block or ", in _send_result_response" in block:
        return "" if ", in await_or_execute" in block else result_advice(_action(sources))
    return ""


#: A callback that is called where it should be given.
_CALLED = re.compile(r"(?:\b(?:create_\w+|ActionServer|add_\w*callback)\(.*?|callback=)(self\.\w+)\(\)")
#: One that is called with its arguments, and has raised the error.
_CALLED_WITH = re.compile(r"\badd_\w*callback\((self\.(\w+))\(.{0,200}\n(?:[ ~^]*\n)?  File .*, in \2\n")
_ARGUMENTS = (
    "The arguments of a callback: self, and then the message for a subscription, nothing for a timer, the request and "
    "the response for a service, the future for add_done_callback(), the goal handle for an action."
)


def _action(sources: Mapping[str, str]) -> str:
    """Return the name of the action's class in the student's files."""
    match = re.search(r"Action(?:Server|Client)\(\s*self,\s*(\w+)", "\n".join(sources.values()))
    return match[1] if match else "Fibonacci"


def _of_a_field(last: LastError, sources: Mapping[str, str]) -> str:
    """Explain fields of a message that are given without their names."""
    match = re.search(r"TypeError: ((\w+?)(?:_\w+)?)\.__init__\(\) takes 1 positional argument", last.error)
    if not match or not _imports_message(match[2], sources):
        return ""
    return f"A message takes each of its fields by name: {match[1].replace('_', '.')}(field=value)."


def _imports_message(name: str, sources: Mapping[str, str]) -> bool:
    pattern = rf"\.(?:msg|srv|action) import [^\n]{{0,500}}\b{name}\b"
    return any(re.search(pattern, source) for source in sources.values())


def _of_an_attribute(last: LastError, sources: Mapping[str, str]) -> str:
    """Explain a name that an object does not have, by the names that it has."""
    match = re.search(r"AttributeError: '(\w+)' object has no attribute '(\w+)'", last.error)
    if not match:
        return ""
    if match[1] in ("float", "int", "str", "list") and "publish(" in last.text:
        return _of_a_part(match[1], match[2], sources)
    if match[2] != "status" and (fields := _fields(match[1], sources)):
        swapped = _swapped(match[1], match[2], sources)
        return f"The fields of a {match[1].replace('_', '.')} are: {', '.join(fields)}.{swapped}"
    source = sources.get(last.file, "")
    if not re.search(rf"^[ \t]*class {match[1]}\b", source, re.MULTILINE):
        return ""
    if re.search(rf"^def {match[2]}\(self", source, re.MULTILINE):
        return f"def {match[2]} is outside of the class: indent it like the other methods."
    if re.search(rf"^[ \t]+{match[2]} = ", source, re.MULTILINE):
        return (
            f"{match[2]} = … in a method is a local variable, which the others don't have: write self.{match[2]} = …."
        )
    if "Did you mean" in last.error:
        return ""
    names = re.findall(r"\bself\.(\w+)\s*(?::[^=\n]{1,200})?=(?!=)|^[ \t]*def (\w+)\(self", source, re.MULTILINE)
    assigned = sorted({name for pair in names for name in pair if name})
    if match[2] in assigned:
        return f"self.{match[2]} is set only later: set it in __init__, before anything can use it."
    if close := similar(match[2], assigned, cutoff=0.7):
        return f"Your class has self.{close}: is self.{match[2]} a misspelling?"
    return f"No line of your class sets self.{match[2]}." if f"self.{match[2]}" in last.text else ""


def _of_a_name(last: LastError, sources: Mapping[str, str]) -> str:
    """Explain a name that only the object has, a misspelt __init__, and a parameter that has another name."""
    code = sources.get(last.file, "")
    name = re.search(r"NameError: name '(\w+)' is not defined", last.error)
    if name and re.search(rf"^[ \t]+def {name[1]}\(self|\bself\.{name[1]} = ", code, re.MULTILINE):
        return f"A method reaches what belongs to its object through self: write self.{name[1]}."
    misspelt = re.search(r"def (_*ini?t_*)\(self", code)
    if misspelt and "'node_name'" in last.error and "def __init__" not in code:
        return f"Is {misspelt[1]} meant to be __init__, with two underscores on each side?"
    declared = re.findall(r"declare_parameter\(\s*['\"]([\w.]+)", code)
    if "ParameterNotDeclaredException" in last.error and declared:
        return f"Declared is only: {', '.join(dict.fromkeys(declared))}. Use that very name, or declare this one, too."
    return ""


def _swapped(name: str, attribute: str, sources: Mapping[str, str]) -> str:
    """Explain that a service's callback takes the response for the request, if it does."""
    if not name.endswith("_Response") or attribute not in _fields(name.replace("_Response", "_Request"), sources):
        return ""
    return f" {attribute} is a field of the request, which is the callback's argument before the response."


def _of_a_part(kind: str, part: str, sources: Mapping[str, str]) -> str:
    """Explain that a field which is a message itself holds a plain value. `part` is what such a message has."""
    code = "\n".join(sources.values())
    fields = [name for name, parts in _PARTS.items() if part in parts and re.search(rf"\.{name} = ", code)]
    if part in _PARTS["stamp"]:
        return f"A stamp is a message of its own, and holds a {kind} here: self.get_clock().now().to_msg() makes one."
    if len(fields) != 1:
        return f"A field of the message holds a {kind}, but is a message of its own: set its field {part}."
    return f"{fields[0]} holds a {kind}, but is a message of its own: set {fields[0]}.{part}."


def _fields(name: str, sources: Mapping[str, str]) -> list[str]:
    """Return the fields of the message class that the student's files import by this name; empty if there is none.

    That of a service's request or response is `SetBool_Request` or `SetBool_Response`.
    """
    whole, _, part = name.partition("_")
    loaded = (module.partition(".")[0] for module in sys.modules if module.endswith((".srv", ".action")))
    pattern = rf"^[ \t]*from ({'|'.join((*_PACKAGES, *loaded))})\.(msg|srv|action) import [^\n]*\b{whole}\b"
    imported = re.search(pattern, "\n".join(sources.values()), re.MULTILINE)
    try:
        found = message_class(f"{imported[1]}/{imported[2]}/{whole}") if imported else None
        message = getattr(found, part) if part else found
        return list(message.get_fields_and_field_types()) if message else []
    except (ImportError, AttributeError):
        return []


def _of_its_own(last: LastError, sources: Mapping[str, str]) -> str:
    """Say what else there is than to raise an error in the callback of a service."""
    if not last.text.startswith("raise ") or "await_or_execute(srv.callback" not in last.traceback:
        return ""
    if "_set_parameters" in last.traceback:
        return "To refuse a value, return SetParametersResult(successful=False, reason='…'): an error ends the node."
    return "An exception in a callback ends the whole node: say in the response what is wrong, and return it."


def _without_text(last: LastError, sources: Mapping[str, str]) -> str:
    """Say what a library expected whose error has a type and no text."""
    row = last.traceback.splitlines()[-2].strip() if last.traceback.count("\n") > 1 else ""
    if last.raised_there or not last.line or not re.fullmatch(r"[\w.]+:?", last.error):
        return ""
    given = f"`{row}`" if row.startswith("assert ") else "compare the types of the arguments with the chapter"
    return f"The library that this line calls refused what it was given: {given}."
