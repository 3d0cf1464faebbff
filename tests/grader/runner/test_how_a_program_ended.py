"""How a program's end is reported, if ROS 2 itself says little about the line that is to blame."""

from __future__ import annotations

import pytest
from rclpy.node import Node

from grader.recording.printed_paths import without_paths
from grader.runner.node_attributes import PUBLIC
from grader.runner.program_end import of_exit, survived_by
from grader.runner.tracebacks import last_error
from groundwork.process_exit import ProcessExit

SOURCE = "import rclpy\nrclpy.spin(node)\n"

#: As rclpy 7.1.6 wrote them, shortened.
NO_RESPONSE = """\
Traceback (most recent call last):
  File "turnstile.py", line 2, in <module>
    rclpy.spin(node)
  File "rclpy/executors.py", line 472, in _execute_service
    srv.send_response(response, header)
  File "rclpy/service.py", line 75, in send_response
    raise TypeError()
TypeError
"""
RAISES = """\
Traceback (most recent call last):
  File "turnstile.py", line 2, in <module>
    rclpy.spin(node)
  File "rclpy/executors.py", line 456, in _execute
    response = await await_or_execute(srv.callback, request, srv.srv_type.Response())
  File "turnstile.py", line 3, in on_push
ValueError: no coins
"""
UNDECLARED = """\
Traceback (most recent call last):
  File "rclpy/node.py", line 678, in get_parameter
    raise ParameterNotDeclaredException(name)
rclpy.exceptions.ParameterNotDeclaredException: Invalid access to undeclared parameter(s): gain
"""
OF_ANOTHER_TYPE = """\
Traceback (most recent call last):
  File "rclpy/node.py", line 575, in declare_parameters
    raise InvalidParameterTypeException(name, value.type_)
rclpy.exceptions.InvalidParameterTypeException: Trying to set parameter 'gain' to a DOUBLE, its type is INTEGER
"""
NO_RESULT = (
    "python: ./action/_rotate_absolute_s.c:145: turtlesim__action__rotate_absolute__result__convert_from_py: Assertion "
    '`strncmp("turtlesim.action._rotate_absolute.RotateAbsolute_Result", full_classname_dest, 55) == 0\' failed.\n'
)


@pytest.mark.parametrize(
    ("log", "exit_", "message"),
    [
        (NO_RESPONSE, ProcessExit(1, None, None), "end each way through it with `return response`"),
        (
            NO_RESULT,
            ProcessExit(None, 6, None),
            "has to return a Result, such as `return RotateAbsolute.Result()`",
        ),
        (
            RAISES,
            ProcessExit(1, None, None),
            "coins in line 3: `raise ValueError('no coins')`. An exception in a callback ends the whole node: say",
        ),
        (
            UNDECLARED,
            ProcessExit(1, None, None),
            "(s): gain. Declare it first, in __init__: self.declare_parameter(…).",
        ),
        (
            OF_ANOTHER_TYPE,
            ProcessExit(1, None, None),
            "type is INTEGER. A parameter has the type of its default: 1 declares",
        ),
        ("", ProcessExit(None, 6, None), "killed by signal 6"),
    ],
)
def test_an_end_far_from_its_cause_says_what_to_do(log: str, exit_: ProcessExit, message: str) -> None:
    assert message in of_exit(exit_, log, {"turnstile.py": f"{SOURCE}raise ValueError('no coins')"})[0]


#: As rclpy 7.1.6 wrote them, shortened: an execute callback that returns nothing, and one that raises.
NOTHING_RETURNED = """\
Traceback (most recent call last):
  File "turnstile.py", line 2, in <module>
    rclpy.spin(node)
  File "rclpy/action/server.py", line 366, in _execute_goal
    result_response.result = execute_result
  File "turnstile_interfaces/action/_push.py", line 301, in result
    assert \\
AssertionError: The 'result' field must be a sub message of type 'Push_Result'
"""
GOAL_RAISES = """\
Traceback (most recent call last):
  File "turnstile.py", line 2, in <module>
    rclpy.spin(node)
  File "rclpy/action/server.py", line 349, in _execute_goal
    execute_result = await await_or_execute(execute_callback, goal_handle)
  File "turnstile.py", line 1, in on_goal
RuntimeError: stuck
"""


def test_the_advice_to_return_a_result_is_not_for_an_error_of_the_students_own() -> None:
    returned, raised = (
        of_exit(ProcessExit(1, None, None), log, {"turnstile.py": SOURCE})[0] for log in (NOTHING_RETURNED, GOAL_RAISES)
    )

    assert "has to return a Result" in returned
    assert raised == "RuntimeError: stuck in line 1: `import rclpy`."


#: As rclpy 7.1.6 wrote them, shortened: while the program ends, rclpy's executor ends the goal that was under way.
OF_A_GOAL = """\
Traceback (most recent call last):
  File "rclpy/action/server.py", line 349, in _execute_goal
    execute_result = await await_or_execute(execute_callback, goal_handle)
  File "turnstile.py", line 1, in on_goal
rclpy._rclpy_pybind11.RCLError: Failed to publish feedback
"""
HEADER, FIRST, *OTHERS = OF_A_GOAL.splitlines(keepends=True)


@pytest.mark.parametrize(
    "log",
    [
        OF_A_GOAL + RAISES,
        RAISES + OF_A_GOAL,
        HEADER + FIRST + RAISES + "".join(OTHERS),
        RAISES + "".join(OTHERS),
    ],
    ids=["before", "after", "around", "the rest after"],
)
def test_an_error_that_another_thread_prints_is_not_the_one_that_ended_the_program(log: str) -> None:
    expected = of_exit(ProcessExit(1, None, None), RAISES, {"turnstile.py": SOURCE + "raise ValueError('no coins')"})

    assert expected[1] == 3
    assert (
        of_exit(ProcessExit(1, None, None), log, {"turnstile.py": SOURCE + "raise ValueError('no coins')"}) == expected
    )


FORGED = "Traceback (most recent call last):\n"


@pytest.mark.parametrize(
    "log",
    [
        FORGED + " \n" * 60_000,
        FORGED + '  File "' * 20_000,
        FORGED + f'  File "turnstile.py", line {"1" * 60_000}\n',
        (FORGED + '  File "turnstile.py", line 1, in <module>\n') * 2_000,
    ],
    ids=["blank lines", "names without an end", "a line number without an end", "no errors"],
)
def test_a_forged_traceback_is_read_and_changes_nothing(log: str) -> None:
    assert of_exit(ProcessExit(1, None, None), log, {"turnstile.py": SOURCE})[0] == "it gave up with exit code 1."


def test_of_an_error_as_long_as_a_book_the_beginning_is_told() -> None:
    log = RAISES.replace("no coins", "1" * 60_000)

    text, line = of_exit(ProcessExit(1, None, None), log, {"turnstile.py": SOURCE})

    assert line == 3
    assert text.startswith("ValueError: 11111")
    assert len(text) < 1_000


NODE = """\
import rclpy
from geometry_msgs.msg import Twist
from rclpy.node import Node

class Turnstile(Node):
    def __init__(self):
        super().__init__('turnstile')
        self.coins = 0
        ActionServer(self, Push, '/push', self.execute)

    def on_push(self, message):
        self.coin += 1
"""


def raised(line: int, error: str, *frames: str) -> str:
    """Return a traceback through this line of the node, and what it led to."""
    row = NODE.splitlines()[line - 1].strip()
    return (
        f'Traceback (most recent call last):\n  File "turnstile.py", line {line}, in x\n    {row}\n'
        + "".join(f"  {frame}\n" for frame in frames)
        + f"{error}\n"
    )


@pytest.mark.parametrize(
    ("log", "source", "advice"),
    [
        (
            raised(7, "AttributeError: handle cannot be modified after node creation"),
            NODE.replace("self.coins", "self.handle"),
            "Every Node already has an attribute `handle`: the node's object in ROS's C library. Choose another name",
        ),
        (
            raised(8, "AttributeError: property 'timers' of 'Turnstile' object has no setter"),
            NODE.replace("self.coins", "self.timers"),
            "Every Node already has an attribute `timers`: the list of its timers.",
        ),
        (
            raised(
                7,
                "TypeError: 'method' object does not support the context manager protocol",
                'File "rclpy/node.py", line 206, in __init__',
                "  with self.handle:",
            ),
            NODE.replace("on_push", "handle"),
            "Every Node already has an attribute `handle`",
        ),
        (
            raised(8, "TypeError: 'NoneType' object does not support the context manager protocol").replace(
                "self.coins = 0", "with rclpy.init():"
            ),
            NODE.replace("self.coins = 0", "with rclpy.init():"),
            "This is ROS 2 Jazzy, in which rclpy.init() can't follow `with`, as in newer versions.",
        ),
        (
            raised(12, "AttributeError: 'Turnstile' object has no attribute 'coin'"),
            NODE,
            "Your class has self.coins: is self.coin a misspelling?",
        ),
        (
            raised(9, "TypeError: Turnstile.execute() missing 1 required positional argument: 'goal'").replace(
                "self.execute", "self.execute()"
            ),
            NODE.replace("self.execute", "self.execute()"),
            "Give self.execute without parentheses: with them, it is called at once.",
        ),
        (
            raised(7, "TypeError: Node.__init__() missing 1 required positional argument: 'node_name'"),
            NODE,
            "The node's name goes in here: super().__init__('name').",
        ),
        (
            raised(12, "AttributeError: 'Turnstile' object has no attribute 'pub'. Did you mean: 'publishers'?"),
            NODE.replace("self.coins = 0", "pub = self.create_publisher(Twist, '/x', 10)"),
            "has no attribute 'pub' in line 12: `self.coin += 1`. pub = … in a method is a local variable, which the "
            "others don't have: write self.pub = ….",
        ),
        (
            raised(12, "TypeError: ActionClient.__init__() missing 1 required positional argument: 'action_name'"),
            NODE,
            "The node comes first: ActionClient(self, Type, '/name').",
        ),
        (
            raised(12, "AttributeError: 'Turnstile' object has no attribute 'on_push'"),
            NODE.replace("    def on_push", "def on_push"),
            "def on_push is outside of the class: indent it like the other methods.",
        ),
        (
            raised(12, "TypeError: Node.__init__() missing 1 required positional argument: 'node_name'"),
            NODE.replace("__init__", "_init_"),
            "Is _init_ meant to be __init__, with two underscores on each side?",
        ),
        (
            raised(12, "NameError: name 'on_push' is not defined"),
            NODE,
            "A method reaches what belongs to its object through self: write self.on_push.",
        ),
        (
            raised(12, "rclpy.exceptions.ParameterNotDeclaredException: Invalid access to undeclared parameter(s): x"),
            NODE.replace("self.coins = 0", "self.declare_parameter('X', 1)"),
            "Declared is only: X. Use that very name, or declare this one, too.",
        ),
        (
            raised(12, "AttributeError: 'Future' object has no attribute 'coins'").replace("self.coin", "handle.coin"),
            NODE.replace("self.coin += 1", "handle = future"),
            "A future is not yet the answer",
        ),
        (
            raised(9, "TypeError: Turnstile.on_push() missing 1 required positional argument: 'message'").replace(
                "ActionServer(self, Push, '/push', self.execute)", "client.send(goal, feedback_callback=self.on_push())"
            ),
            NODE.replace(
                "ActionServer(self, Push, '/push', self.execute)", "client.send(goal, feedback_callback=self.on_push())"
            ),
            "Give self.on_push without parentheses",
        ),
        (
            raised(9, "AttributeError: 'NoneType' object has no attribute 'success'").replace(
                "ActionServer(self, Push, '/push', self.execute)\n",
                "future.add_done_callback(self.on_push(future))\n"
                '                             ^^^^^^^^^^^^^^\n  File "turnstile.py", line 12, in on_push\n',
            ),
            NODE,
            "Give self.on_push without parentheses",
        ),
        (
            "TypeError: 'list' object cannot be interpreted as an integer\n\n"
            "The above exception was the direct cause of the following exception:\n\n"
            + raised(
                12,
                "SystemError: <built-in method publish of x at 0x7ff06f507870> returned a result with an exception set",
            ),
            NODE,
            "'list' object cannot be interpreted as an integer in line 12: `self.coin += 1`. A number belongs",
        ),
        (
            raised(12, "rclpy._rclpy_pybind11.RCLError: invalid transition from state SUCCEEDED, at /src/goal.c:100"),
            NODE,
            "RCLError: invalid transition from state SUCCEEDED in line 12: `self.coin += 1`. This goal has ended",
        ),
        (
            raised(12, "AttributeError: 'Twist' object has no attribute 'speed'"),
            NODE,
            "The fields of a Twist are: linear, angular.",
        ),
        (
            raised(12, "AttributeError: 'SetBool_Response' object has no attribute 'data'"),
            NODE.replace("geometry_msgs.msg import Twist", "std_srvs.srv import SetBool"),
            "The fields of a SetBool.Response are: success, message. data is a field of the request, which is",
        ),
        (
            raised(12, "AttributeError: 'float' object has no attribute 'x'"),
            NODE.replace("self.coin += 1", "twist.linear = 0.5; self.publisher.publish(twist)"),
            "linear holds a float, but is a message of its own: set linear.x.",
        ),
        (
            raised(12, "AttributeError: 'float' object has no attribute 'sec'"),
            NODE.replace("self.coin += 1", "self.publisher.publish(header)"),
            "A stamp is a message of its own, and holds a float here: self.get_clock().now().to_msg() makes one.",
        ),
        (
            raised(12, "rclpy.exceptions.ParameterNotDeclaredException: Invalid access to undeclared parameter(s): x"),
            NODE.replace("self.coins", "self._parameters"),
            "Every Node already has an attribute `_parameters`",
        ),
        (
            raised(
                12, "TypeError", 'File "rclpy/action/server.py", line 133, in publish_feedback', "  raise TypeError()"
            ),
            NODE,
            "publish_feedback() takes a whole message: Push.Feedback(…), with the value in its field.",
        ),
        (
            raised(12, "AssertionError", 'File "rclpy/publisher.py", line 1, in f', "  assert isinstance(depth, int)"),
            NODE,
            "refused what it was given: `assert isinstance(depth, int)`.",
        ),
        (
            raised(12, "AssertionError: The 'x' field must be of type 'float'"),
            NODE,
            "A float field needs a float: write 2.0 instead of 2, or float(value).",
        ),
        (
            raised(
                12,
                "AttributeError: 'Turnstile' object has no attribute '_default_callback_group'",
                'File "rclpy/node.py", line 1, in default_callback_group',
                "  return self._default_callback_group",
            ),
            NODE,
            "Begin __init__ with super().__init__('name'): that makes the node.",
        ),
        (
            raised(
                12,
                "TypeError: rclpy_resolve_name(): incompatible function arguments. The following types",
            ),
            NODE,
            "The class of the messages comes before the name",
        ),
        (
            raised(12, "TypeError: Node.destroy_node() missing 1 required positional argument: 'self'"),
            NODE,
            "Write parentheses after the class: node = MyNode().",
        ),
        (
            raised(12, "ImportError: Cannot load backend 'TkAgg', as 'headless' is currently running"),
            NODE,
            "A node that is graded has no screen.",
        ),
        (
            raised(
                12,
                "TypeError: on_push() takes 1 positional argument but 2 were given",
                'File "rclpy/executors.py", line 111, in await_or_execute',
                "  return callback(*args)",
            ),
            NODE,
            "The arguments of a callback: self, and then the message for a subscription",
        ),
        (
            raised(5, "rclpy.exceptions.InvalidTopicNameException: Invalid topic name: must not contain …"),
            NODE.replace(NODE.splitlines()[4], "        self.a = self.create_publisher(Bool, '/a\u200b', 10)"),
            "It has the character U+200B (ZERO WIDTH SPACE), which no name may have: type that part again.",
        ),
    ],
)
def test_advice_names_what_the_student_can_change(log: str, source: str, advice: str) -> None:
    assert advice in of_exit(ProcessExit(1, None, None), log, {"turnstile.py": source})[0]


@pytest.mark.parametrize(
    ("error", "source", "row"),
    [
        (
            "TypeError: Turnstile.on_push() takes 1 positional argument but 2 were given",
            "class Turnstile(Node):\n    def on_push(self):\n        pass\n\n\nrclpy.spin(Turnstile())\n",
            "def on_push(self):",
        ),
        (
            "TypeError: 'NoneType' object is not callable",
            "class Turnstile(Node):\n    def __init__(self):\n        self.create_timer(1.0, self.on_timer())\n",
            "self.create_timer(1.0, self.on_timer())",
        ),
    ],
)
def test_the_callback_that_rclpy_can_not_call_is_the_line_to_look_at(error: str, source: str, row: str) -> None:
    log = raised(5, error, 'File "rclpy/executors.py", line 111, in await_or_execute')
    message, line = of_exit(ProcessExit(1, None, None), log, {"turnstile.py": source})
    assert f"in line {line}: `{row}`" in message
    assert line == source[: source.index(row)].count("\n") + 1


def test_an_attribute_that_another_class_lacks_is_not_taken_for_a_node_without_its_init() -> None:
    log = raised(12, "AttributeError: 'Coin' object has no attribute '_value'", '  File "coins.py", line 3, in value')
    sources = {"turnstile.py": f"class Coin(Money): ...\n\n{NODE}"}

    assert "super().__init__" not in of_exit(ProcessExit(1, None, None), log, sources)[0]


@pytest.mark.parametrize(
    ("error", "advice"),
    [
        ("TypeError: 'NoneType' object is not callable", "Give the method itself, such as self.on_timer"),
        ("AttributeError: 'Time' object has no attribute 'sec'", "its to_msg() is one"),
        (
            "SystemError: <function x at 0x7fdf61b63380> returned a result with an exception set",
            "takes an int",
        ),
        (
            "TypeError: unsupported operand type(s) for *: 'Parameter' and 'float'",
            "get_parameter() returns a Parameter",
        ),
        ("TypeError: 'float' object is not iterable", "write [value]"),
        ("TypeError: 'float' object is not subscriptable", "one number and no list"),
        ('TypeError: can only concatenate str (not "float") to str', "f'{number} m' makes one"),
        (
            "TypeError: 'Range' object is not subscriptable",
            "A Range is not a list. Where a list belongs, write [value]",
        ),
        ("TypeError: must be real number, not str", "A number belongs here: float(text)"),
        ("TypeError: 'list' object cannot be interpreted as an integer", "A number belongs here"),
        ("TypeError: 'float' object cannot be interpreted as an integer", "int(value) makes one"),
        ("AttributeError: 'method' object has no attribute 'success'", "with () behind its name, it is called"),
        ("TypeError: unsupported operand type(s) for +: 'float' and 'method'", "with () behind its name"),
        ("TypeError: 'property' object is not iterable", "node = MyNode()"),
        ("TypeError: module() takes at most 2 arguments (3 given)", "class MyNode(rclpy.node.Node)"),
        (
            "TypeError: descriptor '__init__' requires a 'super' object but received a 'str'",
            "Write parentheses after super",
        ),
        ("AttributeError: 'Turnstile' object has no attribute 'spin'", "rclpy.spin(node)"),
        ("AttributeError: 'Parameter' object has no attribute 'get_value'", "its value is get_parameter(…).value"),
        ("ImportError: cannot import name 'N' from 'rclpy' (/x/rclpy/__init__.py)", "'N' from 'rclpy' in line 12"),
        ("TypeError: 'bool' object is not callable", "leave out ()"),
        ("NotImplementedError: Service classes can not be instantiated", "Type.Request() of a service"),
        ("RuntimeError: Context.init() must only be called once", "once, in main(), is enough"),
        ("TypeError: unsupported operand type(s) for +: 'Time' and 'float'", "Duration(seconds=0.5)"),
        ("TypeError: '>' not supported between instances of 'Duration' and 'int'", "is duration.nanoseconds"),
        ("TypeError: unsupported operand type(s) for ^: 'float' and 'float'", "A power is written with **"),
        ("FileNotFoundError: [Errno 2] No such file or directory: '<robot/>'", "fromstring(text) reads one"),
        ("rclpy.exceptions.InvalidParameterValueException: Invalid parameter value (2)", "does not allow this value"),
        ("TypeError: 'Twist' object is not iterable", "A Twist is not a list."),
        (
            "TypeError: unsupported operand type(s) for -: 'array.array' and 'array.array'",
            "A list of numbers is no number",
        ),
        (
            "AttributeError: 'Future' object has no attribute 'success'",
            "A future is not yet the answer: call",
        ),
        (
            "AttributeError: 'Push_FeedbackMessage' object has no attribute 'coins'",
            "a message inside: message.feedback.coins.",
        ),
        ("TypeError: bad argument type for built-in operation", "takes a str only"),
        ("RuntimeError: no running event loop", "rclpy runs callbacks without asyncio"),
        ("TypeError: float() argument must be a string or a real number, not 'method'", "The period comes first"),
        ("IndexError: array assignment index out of range", "append() makes it longer"),
        ("TypeError: unsupported operand type(s) for -: 'Time' and 'Time'", "stamp.nanosec * 1e-9"),
        ("EOFError: EOF when reading a line", "leave out input()"),
        ("ModuleNotFoundError: No module named 'matplotlib'", "not installed here: pip install matplotlib, or in a"),
        ("AttributeError: module 'xml' has no attribute 'etree'", "imported as a whole"),
        ("AttributeError: 'list' object has no attribute 'name'", "a list of parameters"),
        ("FileNotFoundError: [Errno 2] No such file or directory: '/home/x'", "runs on another computer"),
        ("TypeError: can't multiply sequence by non-int of type 'float'", "'0.5' is a text"),
        ("UnboundLocalError: cannot access local variable 'n'", "self.name, set in __init__"),
        ("rclpy.exceptions.ParameterAlreadyDeclaredException: ['gain']", "Declare it once, in __init__"),
        ("AttributeError: 'Service' object has no attribute 'service_is_ready'", "is made by create_client()"),
        ("AttributeError: 'Subscription' object has no attribute 'publish'", "is made by create_publisher()"),
        (
            "AttributeError: type object 'str' has no attribute '_TYPE_SUPPORT' This might be a ROS 1 m",
            "SUPPORT' in line",
        ),
        ("AttributeError: type object 'str' has no attribute '_TYPE_SUPPORT'", "comes before the name"),
        (
            "RuntimeError: Subscription.__init__(): callback should be either be callable with",
            "without quotes, and",
        ),
        ("AttributeError: 'function' object has no attribute 'add_entity'", "0.25, not 0,25"),
        ("TypeError: must be real number, not tuple", "0.5 and not 0,5"),
        ("TypeError: unsupported operand type(s) for -: 'tuple' and 'float'", "0.5 and not 0,5"),
        ("AttributeError: 'Time' object has no attribute 'to_sec'. Did you mean: '_sec'?", "'to_sec' in line 12"),
        ("AttributeError: 'Time' object has no attribute 'to_sec'", "stamp.sec + stamp.nanosec * 1e-9"),
        ("AttributeError: 'Push_Result' object has no attribute 'status'", "has two fields: status, and result"),
    ],
)
def test_advice_on_errors_that_beginners_meet_in_rclpy(error: str, advice: str) -> None:
    log = raised(12, error, 'File "rclpy/executors.py", line 111, in await_or_execute', "  return callback(*args)")

    text, _ = of_exit(ProcessExit(1, None, None), log, {"turnstile.py": NODE})

    assert advice in text
    assert " at 0x" not in text, "it is another one in each run"


def test_a_value_of_another_type_that_aborts_the_program_is_named_with_its_line() -> None:
    log = "python: ./_push_s.c:153: a__action__push__result__convert_from_py: Assertion `PyFloat_Check(field)' failed."
    # As Python 3.11 prints it.
    stack = (
        "\nFatal Python error: Aborted\n\nStack (most recent call first):\n"
        '  File "/x/lib/python3.11/site-packages/rclpy/publisher.py", line 70 in publish\n'
        '  File "turnstile.py", line 12 in on_push\n  File "turnstile.py", line 7 in x\n\n'
        "Extension modules: numpy.core._multiarray_umath (total: 1)\n"
    )
    in_c = stack.replace(
        "Extension", "Current thread's C stack trace (most recent call first):\n  Binary file x\n\nExtension"
    )

    text, line = of_exit(ProcessExit(None, 6, None), log + stack, {"turnstile.py": NODE})

    assert line == 12
    # Python 3.14 adds the stack in C.
    assert {without_paths(f"{log}{printed}more\n") for printed in (stack, in_c)} == {f"{log}\nmore\n"}
    pythons_own = "Fatal Python error: _enter_buffered_busy: could not acquire lock at interpreter shutdown\n"
    assert without_paths(pythons_own) == pythons_own
    assert text == (
        "it put a value of another type into a message (push result) in line 12: `self.coin += 1`. A float field of it "
        "needs a float: 2.0 instead of 2, float(value), or the data of a message."
    )
    assert "(push result). A float" in of_exit(ProcessExit(None, 6, None), log, {"turnstile.py": NODE})[0]


def test_a_log_that_is_one_long_word_is_read_in_no_time() -> None:
    text, _ = of_exit(ProcessExit(None, 9, None), "_" * 128 * 1024, {"turnstile.py": NODE})
    assert text == "it was killed by signal 9."


def test_the_first_exception_that_a_program_survives_is_said_with_its_type_line_and_source() -> None:
    log = "[ERROR] [turnstile]: Error raised in execute callback: \n" + raised(
        12, "ZeroDivisionError: division by zero"
    )

    assert survived_by(log + raised(8, "KeyError: 'x'"), {"turnstile.py": NODE}) == (
        "Your program raised an exception: ZeroDivisionError: division by zero in line 12: `self.coin += 1`."
    )


@pytest.mark.parametrize(
    ("source", "advice"),
    [
        ("from coins.srv import Push\n", "each of its fields by name: Push.Response(field=value)."),
        ("class Push_Response:\n    pass\n", "but 2 were given in line 3."),
    ],
)
def test_a_message_whose_fields_have_no_names_is_explained_and_no_other_class(source: str, advice: str) -> None:
    error = "TypeError: Push_Response.__init__() takes 1 positional argument but 2 were given"

    text, _ = of_exit(
        ProcessExit(1, None, None), RAISES.replace("ValueError: no coins", error), {"turnstile.py": source}
    )

    assert text.endswith(advice)


def test_a_program_that_spins_once_learns_what_stays() -> None:
    text, _ = of_exit(ProcessExit(0, None, None), "", {"turnstile.py": "rclpy.spin_once(node)\n"})

    assert text.endswith("spin_once() returns after one callback; rclpy.spin(node) stays until Ctrl-C.")


def test_an_attribute_of_node_that_is_replaced_without_an_error_is_named() -> None:
    assert survived_by("", {"turnstile.py": NODE}) == ""
    assert survived_by("", {"turnstile.py": NODE.replace("self.coins", "self._timers")}).startswith(
        "Your class sets self._timers, in which rclpy's Node keeps the list of its timers"
    )


def test_the_attributes_of_node_are_those_of_this_rclpy() -> None:
    properties = {name for name in dir(Node) if isinstance(getattr(Node, name), property)}

    assert set(PUBLIC) == properties


def test_a_line_of_a_megabyte_does_not_keep_the_grader_busy() -> None:
    """Patterns would take minutes for it, and each scenario again."""
    log = RAISES.partition('  File "turnstile.py", line 3')[0] + "TypeError: 'NoneType' object is not callable\n"
    error = last_error(log, {"turnstile.py": f"{SOURCE}# {'create_timer(' * 75_000}"})
    assert error
    assert error.line == 2


@pytest.mark.parametrize(
    ("error", "repeated"),
    [
        ("AttributeError: 'Turnstile' object has no attribute '_coins'", "\n"),
        ("AttributeError: 'Turnstile' object has no attribute 'coins'", "# class Turnstile(Node"),
        ("AttributeError: 'Turnstile' object has no attribute 'coins'", "# self.a:"),
        ("NameError: name 'coins' is not defined", " \n"),
    ],
)
def test_a_program_of_a_megabyte_does_not_either(error: str, repeated: str) -> None:
    log = RAISES.replace("ValueError: no coins", error)
    source = SOURCE + repeated * (900_000 // len(repeated))
    assert error in of_exit(ProcessExit(1, None, None), log, {"turnstile.py": source})[0]
