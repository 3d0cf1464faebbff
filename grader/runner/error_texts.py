"""Advice on an error by its text alone, as rclpy 7.1 and CPython 3.10 to 3.14 write it."""

from __future__ import annotations

import re
from collections.abc import Mapping

from grader.runner.tracebacks import LastError
from grader.submission.python_code import MATPLOTLIB

_NO_SCREEN = (
    "A node that is graded has no screen. Leave out windows and plots: %plot in a notebook draws what it sends."
)

#: What to do about an error, by a pattern of its last line.
_BY_TEXT = (
    (r"ParameterNotDeclaredException", "Declare it first, in __init__: self.declare_parameter(…)."),
    (r"returned an invalid type", "An on-set callback has to return a SetParametersResult, each way through it."),
    (r"InvalidParameterValue", "The declared range or the on-set callback does not allow this value."),
    (r"ParameterTypeException", "A parameter has the type of its default: 1 declares an integer, 1.0 a double."),
    (r"field must be of type 'float'", "A float field needs a float: write 2.0 instead of 2, or float(value)."),
    (
        r"Expected <class '[\w.]*\.(\w+)'>, got <class '[\w.]+'>",
        r"publish() takes a whole \1: create one, put the value into its field, and publish that.",
    ),
    (r"event CANCELED", "canceled() is only for a goal with a request to cancel; call abort() to give up any other."),
    (r"with event EXECUTE\b", "The goal executes already when rclpy calls this callback: leave out execute()."),
    (r"transition from state (?:SUCCEEDED|ABORTED|CANCELED)", "This goal has ended already: end each goal only once."),
    (r"no display|Cannot load backend|could not connect to display|No module named '_?tkinter'", _NO_SCREEN),
    (
        rf"No module named '(?:{'|'.join(MATPLOTLIB)})\b",
        "It is not installed here: pip install matplotlib, or in a notebook %pip install matplotlib.",
    ),
    (
        r"'(?:Time|Duration)' object has no attribute '(?:to_n?sec|n?secs)'",
        "That is ROS 1's. In ROS 2 the seconds of a stamp are stamp.sec + stamp.nanosec * 1e-9.",
    ),
    (r"'Time' object has no attribute '(?:nano)?sec'", "A Time is not yet a stamp: its to_msg() is one."),
    (
        r"'\w+' object has no attribute 'add_entity'",
        "An argument of this line is taken for a callback group: is there one too many? A decimal number has a point: "
        "0.25, not 0,25.",
    ),
    (
        r"not tuple\b|'tuple' and|and 'tuple'",
        "A comma makes a tuple, which is no number: a decimal number has a point, 0.5 and not 0,5.",
    ),
    (
        r"must be real number, not (?!NoneType)|'(?!float|NoneType)\w+' object cannot be interpreted as an integer",
        "A number belongs here: float(text) and int(text) make one, and that of a message is in its field, as in "
        "message.data.",
    ),
    (r"returned a result with an exception set", "A field has a value of another type: an integer field takes an int."),
    (r"of type 'int'|'float' object cannot be interpreted as an int", "An integer belongs here: int(value) makes one."),
    (
        r"'(?:\w*function\w*|method)' (?:object (?:has no|is not)|and )|and '(?:function|method)'",
        "A function without parentheses is no value yet: with () behind its name, it is called.",
    ),
    (r"'(?:bool|int|float)' object is not callable", "This is no function: leave out (), or write * for a product."),
    (r"classes can not be instantiated", "Create a Type.Request() of a service, a Type.Goal() of an action."),
    (r"has no attribute 'spin'", "spin is a function of rclpy: rclpy.spin(node)."),
    (r"module\(\) takes at most 2", "A module is no class: class MyNode(rclpy.node.Node)."),
    (r"requires a 'super' object", "Write parentheses after super: super().__init__('name')."),
    (r"init\(\) must only be called once", "rclpy.init() is called a second time here: once, in main(), is enough."),
    (
        r"operand type.*'Parameter'|'Parameter' object has no",
        "get_parameter() returns a Parameter, and its value is get_parameter(…).value.",
    ),
    (
        r"operand type\(s\) for \S+ '(?:array\.array|list)'",
        "A list of numbers is no number: calculate with one element of it at a time, in a loop.",
    ),
    (r"bad argument type for built-in", "A text field takes a str only: str(value), or get_parameter(…).value."),
    (
        r"has no attribute '_TYPE_SUPPORT'|rclpy_resolve_name\(\): incompatible function arguments",
        "The class of the messages comes before the name, without quotes: create_publisher(String, '/name', 10).",
    ),
    (
        r"no running event loop",
        "rclpy runs callbacks without asyncio, so asyncio.sleep() and the like can't be used in one. To continue "
        "later, create a timer; to wait for an answer, await the future of call_async() or send_goal_async() itself.",
    ),
    (
        r"module '[\w.]+' has no attribute",
        "Is the name spelled right? If it is a module itself, it must be imported as a whole: import xml.etree.",
    ),
    (r"'list' object has no attribute '(?:name|value|type_)'", "The callback gets a list of parameters: loop over it."),
    (
        r"multiply sequence by non-int|only concatenate (?:str|list)|unsupported operand type\(s\) for .*'str'",
        "A value of this line is a text or a list, and no number: '0.5' is a text, and f'{number} m' makes one.",
    ),
    (r"argument: 'self'|'property' object is not iterable", "Write parentheses after the class: node = MyNode()."),
    (r"required positional argument: 'qos_profile'", "The last argument is the queue depth, such as 10."),
    (r"required positional argument: 'action_name'", "The node comes first: ActionClient(self, Type, '/name')."),
    (r"required positional argument: 'node_name'", "The node's name goes in here: super().__init__('name')."),
    (r"float\(\) argument must be .*, not 'method'", "The period comes first: create_timer(period, self.on_timer)."),
    (r"assignment index", "The list is shorter than that: a new one is empty, and append() makes it longer."),
    (
        r"'(?:Time|Duration)' and '(?:int|float)'|'(?:int|float)' and '(?:Time|Duration)'",
        "This takes a Duration and no plain number: Duration(seconds=0.5). The number in one is duration.nanoseconds.",
    ),
    (r"for \^:", "A power is written with **, as in x ** 2: in Python, ^ is something else."),
    (r"for -: 'Time' and 'Time'", "A stamp is no number: stamp.sec + stamp.nanosec * 1e-9 is its time in seconds."),
    (r"EOFError", "Nobody types anything while a node is graded: leave out input()."),
    (r"ParameterAlreadyDeclaredException", "Declare it once, in __init__, and not in a callback."),
    (
        r"UnboundLocalError",
        "A function that assigns to a name has a variable of its own with this name, and came here without setting it. "
        "What a node remembers is an attribute: self.name, set in __init__.",
    ),
    (r"FileNotFoundError.*: '\s*<", "A file's name belongs here, and this is a text: fromstring(text) reads one."),
    (r"FileNotFoundError", "Your node runs on another computer, which has only the files that you hand in."),
    (
        r"callback should be either be callable",
        "The callback is the method itself, without quotes, and takes the message: def on_message(self, message).",
    ),
    (
        r"'ServerGoalHandle' object has no attribute",
        "A goal handle has request, which is the goal, and is_cancel_requested, succeed(), canceled(), abort() and "
        "publish_feedback().",
    ),
    (r"_Result' object has no attribute 'status'", "What it brings has two fields: status, and result, the message."),
    (r"_FeedbackMessage' object has no attribute '(\w+)'", r"The feedback is a message inside: message.feedback.\1."),
    (r"'Future' object has no", "A future is not yet the answer: call future.result() in its add_done_callback()."),
    (r"'Service' object has no", "This is the side that answers. The side that asks is made by create_client()."),
    (r"'Subscription' object has no", "This is the side that receives. The other is made by create_publisher()."),
    (r"'(?:float|int|bool)' object is not s", "This is one number and no list: it has no index."),
    (r"'(?:float|int|bool)' object is not i", "A list belongs here: write [value], or to count range(number)."),
    (
        r"'([A-Z]\w*)' object is not (?:iterable|subscriptable)",
        r"A \1 is not a list. Where a list belongs, write [value]; if one of its fields is a list, use that field.",
    ),
    (r"during iteration", "The line changes what the loop goes through: loop over list(…) of it."),
)


def advice_on_text(last: LastError, sources: Mapping[str, str]) -> str:
    """Return what to do about an error whose text is one of those; "" otherwise."""
    for pattern, advice in _BY_TEXT:
        if match := re.search(pattern, last.error):
            return match.expand(advice) if match.groups() else advice
    return ""
