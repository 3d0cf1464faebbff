"""Fields that do not exist, and values of other types, are reported before anything runs; nothing else is."""

from __future__ import annotations

from pathlib import Path

import pytest
from fences import IMPORTS, MAIN, TALKER, reading

from groundwork.problem import Severity
from spinbook.chapter.wrong_fields import wrong_fields

MSGS = "from std_msgs.msg import Float64, String\nfrom geometry_msgs.msg import PoseArray, Twist\n"
SRV = "from example_interfaces.srv import AddTwoInts\n"
ACTION = "from example_interfaces.action import Fibonacci\nfrom rclpy.action import ActionClient, ActionServer\n"


def node(setup: str, method: str) -> str:
    """Return a class with a statement in its constructor and a method."""
    return f"class A(Node):\n    def __init__(self):\n        super().__init__('a')\n        {setup}\n    {method}\n"


@pytest.mark.parametrize(
    ("code", "problem", "fix"),
    [
        (f"{MSGS}Float64(dat=1.0)", "`Float64` has no field `dat`.", "Did you mean `data`?"),
        (f"{MSGS}Float64('a')", "`Float64` takes its fields by name only.", "Name the field: Float64(data='a')"),
        (f"{MSGS}Float64(data=-2)", "`data` of `Float64` is a float64, and this is an integer, `-2`.", "Write `-2.0`"),
        (f"{MSGS}m = String()\nm.data = 5", "`data` of `String` is a string, and this is an integer, `5`.", "Write a"),
        (
            f"{MSGS}m = Twist()\nm.linear = [1.0]",
            "`linear` of `Twist` is a Vector3, and this is a list, `[1.0]`.",
            "Write `Vec",
        ),
        (f"{MSGS}PoseArray(poses=3)", "`poses` of `PoseArray` is a list, and this is an integer, `3`.", "Write `[3]`."),
        (f"{MSGS}m = Twist()\nm.linear.X = 1.0", "`Vector3` has no field `X`.", "Did you mean `x`?"),
        (f"{MSGS}m = PoseArray()\nm.poses[0].position.w", "`Point` has no field `w`.", "Its fields: `x`, `y`, `z`."),
        (f"{MSGS}def f(m: String):\n    return m.text", "`String` has no field `text`.", "Did you mean `data`?"),
        ("import std_msgs.msg\nm = std_msgs.msg.String()\nm.dat", "`String` has no field `dat`.", "Did you mean"),
        (
            MSGS + node("self.create_subscription(String, 'x', self.on, 10)", "def on(self, m):\n        m.dta"),
            "`String` has no field `dta`.",
            "Did you mean `data`?",
        ),
        (
            f"{MSGS}n.create_subscription(String, 'x', lambda m: print(m.dta), 10)",
            "`String` has no field `dta`.",
            "Did you mean `data`?",
        ),
        (
            SRV
            + node(
                "self.create_service(AddTwoInts, 'x', self.on)",
                "def on(self, q, a):\n        a.sum = q.a + q.c\n        return a",
            ),
            "`AddTwoInts.Request` has no field `c`.",
            "Its fields: `a`, `b`.",
        ),
        *(
            (
                SRV
                + node(
                    "self.create_service(AddTwoInts, 'x', callback=self.on)", f"def on(self, q, a):\n        {body}"
                ),
                *said,
            )
            for body, *said in (
                (
                    "a.sum = 1",
                    "`on` can end without returning the service's response.",
                    "End each way through it with `return a`",
                ),
                ("if q.a:\n            return a", "`on` can end without returning the service's response.", "End each"),
                (
                    "return q",
                    "`on` returns `q`, which is not the service's response.",
                    "End each way through it with `return a`",
                ),
            )
        ),
        (
            f"{SRV}{ACTION}"
            + node("ActionServer(self, F, 'x', f, goal_callback=self.go)", "def go(self, g):\n        1"),
            "`go` can end without returning a GoalResponse.",
            "End each way through it with `return GoalResponse.ACCEPT`",
        ),
        (
            MSGS + node("self.add_on_set_parameters_callback(self.on)", "def on(self, p):\n        return True"),
            "`on` returns `True`, which is not a SetParametersResult.",
            "End each way through it with `return SetParametersResult(successful=True)`",
        ),
        (
            ACTION + node("ActionServer(self, Fibonacci, 'x', self.go)", "async def go(self, h):\n        h.succeed()"),
            "`go` can end without returning the action's result.",
            "End each way through it with `return Fibonacci.Result()`",
        ),
        (
            ACTION
            + node(
                "ActionServer(self, Fibonacci, 'x', self.go)", "def go(self, h):\n        h.request.ordr\n        raise"
            ),
            "`Fibonacci.Goal` has no field `ordr`.",
            "Did you mean `order`?",
        ),
        (
            f"{ACTION}f = Fibonacci.Feedback()\nf.numbers = [1]",
            "`Fibonacci.Feedback` has no field `numbers`.",
            "Did you",
        ),
        (
            ACTION
            + node(
                "self.c = ActionClient(self, Fibonacci, 'x'); self.c.send_goal_async(g, feedback_callback=self.on)",
                "def on(self, m):\n        m.feedback.part",
            ),
            "`Fibonacci.Feedback` has no field `part`.",
            "Did you mean `sequence`?",
        ),
        ("import std_msgs.msg as sm\nsm.String().dat", "`String` has no field `dat`.", "Did you mean `data`?"),
        ("from std_msgs import msg\nmsg.String(dat='x')", "`String` has no field `dat`.", "Did you mean `data`?"),
        (
            f"{MSGS}n.create_subscription(msg_type=String, topic='x', callback=lambda m: m.dta, qos_profile=10)",
            "`String` has no field `dta`.",
            "Did you mean `data`?",
        ),
        (
            MSGS
            + node(
                "self.create_subscription(String, 'x', partial(self.on, 1), 10)", "def on(self, n, m):\n        m.dta"
            ),
            "`String` has no field `dta`.",
            "Did you mean `data`?",
        ),
        (f"{MSGS}for i, p in enumerate(PoseArray().poses):\n    p.place", "`Pose` has no field `place`.", "Its fields"),
        (f"{MSGS}for p in PoseArray().poses:\n    p.place", "`Pose` has no field `place`.", "Its fields: `position`"),
        (
            SRV
            + node(
                "self.c = self.create_client(AddTwoInts, 'x'); self.c.call_async(q).add_done_callback(self.on)",
                "def on(self, f):\n        f.result().summ",
            ),
            "`AddTwoInts.Response` has no field `summ`.",
            "Did you mean `sum`?",
        ),
        (
            SRV
            + node(
                "self.c = self.create_client(AddTwoInts, 'x')",
                "async def go(self):\n        r = await self.c.call_async(q)\n        r.c",
            ),
            "`AddTwoInts.Response` has no field `c`.",
            "Did you mean `sum`?",
        ),
        (
            "from diagnostic_msgs.msg import DiagnosticStatus as D\nD(level=D.OKAY)",
            "`DiagnosticStatus` has no constant `OKAY`.",
            "Did you mean `OK`? Its constants: `ERROR`, `OK`",
        ),
        (
            "from std_msgs.msg import Header\nh = Header()\nh.stamp = self.get_clock().now()",
            "`stamp` of `Header` is a message, and `now()` is a time of rclpy, which can't be sent.",
            "Write `self.get_clock().now().to_msg()`.",
        ),
    ],
)
def test_a_wrong_field_is_found_with_the_right_one(code: str, problem: str, fix: str) -> None:
    (wrong,) = wrong_fields(code)

    assert wrong.problem == problem
    assert wrong.fix.startswith(fix) or fix in wrong.fix


@pytest.mark.parametrize(
    "code",
    [
        f"{MSGS}m = String()\nm = other()\nm.text",
        f"{MSGS}def f(m):\n    m.text\nf(String())",
        f"{MSGS}m = String(data='x')\nm.data.upper()\nm.get_fields_and_field_types()\nm.__slots__",
        f"{MSGS}m = String()\nfor m in things:\n    m.text",
        f"{MSGS}class Pose:\n    pass\nfor p in PoseArray().poses:\n    p = Pose()\n    p.text",
        "from std_msgs.msg import Header\nh = Header()\nh.stamp = self.get_clock().now().to_msg()",
        f"{MSGS}def f():\n    m = String()\n    def g(m):\n        return m.text\n    return g",
        f"{MSGS}m = String()\ndef f():\n    m = other()\n    return m.text",
        f"{MSGS}Float64(data='text', check_fields=True)",
        f"{MSGS}try:\n    String().text\nexcept AttributeError:\n    pass",
        f"{MSGS}class String:\n    text = 1\nString().text",
        "from unknown_msgs.msg import Zip\nz = Zip()\nz.anything = 1",
        "from sensor_msgs.msg import BatteryState as B\nb = B()\nb.power_supply_status = B.POWER_SUPPLY_STATUS_FULL",
        f"{SRV}f = client.call_async(AddTwoInts.Request(a=1, b=2))\nf.result().anything",
        MSGS
        + node(
            "self.create_subscription(String, 'x', self.on, 10); self.create_subscription(Other, 'y', self.on, 10)",
            "def on(self, m):\n        m.text",
        ),
        *(
            SRV + node("self.create_service(AddTwoInts, 'x', self.on)", f"def on(self, q, a):\n        {body}")
            for body in (
                "while True:\n            if q.a:\n                return a",
                "try:\n            return a\n        except ValueError:\n            raise",
                "with lock:\n            return a if q.a else AddTwoInts.Response()",
                "if q.a:\n            return a\n        else:\n            return self.other(q)",
            )
        ),
        *(f"{MSGS}x = String(){part * 900}" for part in (".data", "()", "[0]")),
        MSGS + node("self.last = None", "def on(self, m):\n        self.last = String()\n        self.last.text"),
    ],
)
def test_what_is_not_sure_is_not_reported(code: str) -> None:
    assert wrong_fields(code) == []


def test_a_chapter_says_the_line_unless_failing_is_meant(tmp_path: Path) -> None:
    code = IMPORTS + TALKER + "        self.message = String()\n        self.message.dat = 'x'\n" + MAIN
    titled = f'```python title="talker.py" WORD\n{code}```\n'

    (problem,) = reading(tmp_path, titled.replace("WORD", "")).problems
    assert (problem.line, problem.problem) == (11, "`String` has no field `dat`.")
    assert reading(tmp_path, titled.replace("WORD", "raises")).problems == ()
    assert reading(tmp_path, titled.replace("WORD", "expect-error")).problems == ()


def test_a_program_that_never_calls_init_is_reported(tmp_path: Path) -> None:
    (problem,) = reading(
        tmp_path, '```python title="a.py"\n' + IMPORTS + TALKER + MAIN.replace("init", "ok") + "```"
    ).problems

    assert (problem.line, problem.problem) == (12, "nothing calls `rclpy.init` before this, so the program would fail.")


@pytest.mark.parametrize(
    ("command", "problem"),
    [
        ("topic pub /x std_msgs/msg/String '{dat: hi}'", "`String` has no field `dat`"),
        ("topic pub --once -r 2 /x geometry_msgs/msg/Twist '{linear: {q: 1.0}}'", "`Vector3` has no field `q`"),
        (
            "topic pub /x std_msgs/msg/Int32 '{data: many}'",
            "`data` of `Int32` is an int32, and this is a string, `'many'`",
        ),
        ("service call /x turtlesim/srv/SetPen '{off: 0}'", "`SetPen.Request` has no field `False`"),
        ("service call /x std_srvs/srv/SetBool '{dta: true}'", "`SetBool.Request` has no field `dta`"),
        ("action send_goal /x example_interfaces/action/Fibonacci '{ordr: 3}'", "`Fibonacci.Goal` has no field `ordr`"),
    ],
)
def test_a_wrong_field_in_a_command_is_found(tmp_path: Path, command: str, problem: str) -> None:
    problems = reading(tmp_path, f"```bash\n# first\nros2 {command}\n```\n").problems

    assert [(item.line, item.problem) for item in problems if "makes" not in item.problem] == [
        (5, f"{problem} (`ros2 {command}`).")
    ]


def test_right_values_in_commands_are_left_alone(tmp_path: Path) -> None:
    commands = [
        "topic pub /x std_msgs/msg/Float64 '{data: 1}'",
        "topic pub /x geometry_msgs/msg/TwistStamped '{header: auto, twist: {linear: {x: 1}}}'",
        "topic pub -1 /x std_msgs/msg/String 'data: hi'",
        "topic pub /x std_msgs/msg/Empty",
    ]

    assert reading(tmp_path, "```bash\n" + "".join(f"ros2 {each}\n" for each in commands) + "```\n").problems == ()


def test_a_misspelt_command_is_corrected(tmp_path: Path) -> None:
    (verb,) = reading(tmp_path, "```bash\nros2 topic ech /x\n```\n").problems
    (noun,) = reading(tmp_path, "```bash\nros2 tpic list\n```\n").problems
    (program,) = reading(tmp_path, "```bash\nrso2 topic list\n```\n").problems

    assert (verb.problem, verb.fix) == (
        "there is no `ros2 topic ech` here (`ros2 topic ech /x`).",
        "Did you mean `ros2 topic echo`?",
    )
    assert noun.fix == "Did you mean `ros2 topic`?"
    assert program.fix == "Did you mean `ros2`?"
    assert {verb.severity, noun.severity, program.severity} == {Severity.NOT_RUN}


def test_each_verb_of_our_own_ros2_can_stand_in_a_chapter(tmp_path: Path) -> None:
    commands = "ros2 service echo /rosout/x\nros2 pkg xml std_msgs\nros2 topic find std_msgs/msg/String\n"

    assert reading(tmp_path, f"```bash\n{commands}```\n").problems == ()
