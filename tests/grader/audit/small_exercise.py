"""A small exercise that is quick to audit: publish twice each number that is not negative."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

FILES = {
    "exercises/doubler/exercise.toml": """
title = "Twice each number"
points = 10
file = "doubler.py"
class = "Doubler"
node = "doubler"

[[subscribe]]
topic = "/numbers"
type = "std_msgs/msg/Float64"

[[publish]]
topic = "/doubled"
type = "std_msgs/msg/Float64"
""",
    "exercises/doubler/task.md": """# Twice each number

Write the class `Doubler`. It hears `/numbers` and publishes twice each number on
`/doubled`, once.

- **Say nothing to a number below zero.** Zero counts as positive.
- Publish nothing on `/numbers` or `/clock`.
- Your node is called `doubler`, and ends on Ctrl-C.
""",
    "exercises/doubler/scenarios.py": '''"""What it is run against."""

import random

from grader.scenario import Scenario
from grader.scenario.scenario import SECOND, START, Message


def scenarios(seed):
    chance = random.Random(seed)
    streams = {
        "positive": ("numbers above zero", [1.5, 2.0, 4.0, 4.0]),
        "negative": ("numbers on both sides of zero", [1.0, -1.0, 0.0, -0.5, 3.0]),
        "any": ("numbers by chance", [round(chance.uniform(1.0, 9.0), 3) for _ in range(3)]),
    }
    return tuple(
        Scenario(name, title, tuple(
            Message(START + i * SECOND // 10, "/numbers", "std_msgs/msg/Float64", {"data": number})
            for i, number in enumerate(numbers)
        ), interrupt=name == "positive")
        for name, (title, numbers) in streams.items()
    )
''',
    "exercises/doubler/checks.py": '''"""What students may read."""

from grader.checking import Run, check, fail


@check(points=2, hint="Call publish() in the callback.")
def test_publishes(positive: Run) -> None:
    """It publishes on /doubled."""
    if not positive.received:
        fail("Nothing came.", expected="4 messages", got="none")


@check(points=3, hint="Multiply.", depends=[test_publishes])
def test_twice_the_number(positive: Run) -> None:
    """Each number is doubled."""
    positive.must_match("data")


@check(points=1, hint="One publish().", depends=[test_publishes])
def test_once(positive: Run) -> None:
    """Each number is published once."""
    positive.must_answer()


@check(points=1, hint="Look at the name in __init__.", depends=[test_publishes])
def test_is_called_doubler(positive: Run) -> None:
    """The node is called doubler."""
    if positive.nodes != ("/doubler",):
        fail("The node has another name.", expected="/doubler", got=positive.nodes)


@check(points=1, hint="Catch what Ctrl-C raises.", depends=[test_publishes])
def test_ends_on_ctrl_c(positive: Run) -> None:
    """It ends on Ctrl-C."""
    if positive.ending.traceback or not positive.ending.ended_in_time:
        fail("It did not end well.", expected="an end without a traceback", got=positive.ending.traceback)
''',
    "exercises/doubler/hidden_checks.py": '''"""What they may not."""

from grader.checking import Run, check, fail


@check(points=1, hint="Compare with 0.", depends=["test_twice_the_number"],
       rule="Say nothing to a number below zero. Zero counts as positive.")
def test_nothing_below_zero(negative: Run) -> None:
    """It says nothing to a number below zero, and twice zero to zero."""
    negative.must_be_silent()
    negative.must_match("data")


@check(points=1, hint="Publish on one topic only.", depends=["test_publishes"],
       rule="Publish nothing on /numbers or /clock.")
def test_leaves_other_topics_alone(any: Run) -> None:
    """It publishes nothing on /numbers or /clock."""
    if any.publishers("/numbers") or any.publishers("/clock"):
        fail("There is a publisher on /numbers or /clock.", expected="none", got=1)
''',
    "solutions/doubler/solution.py": '''"""Publish twice each number that is not negative."""

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from std_msgs.msg import Float64


class Doubler(Node):
    def __init__(self):
        super().__init__('doubler')
        # BEGIN SOLUTION
        self.publisher = self.create_publisher(Float64, '/doubled', 10)
        self.create_subscription(Float64, '/numbers', self.on_number, 10)

    def on_number(self, message):
        if message.data >= 0:
            self.publisher.publish(Float64(data=2 * message.data))
        # END SOLUTION


def main():
    rclpy.init()
    try:
        rclpy.spin(Doubler())
    except (KeyboardInterrupt, ExternalShutdownException):
        rclpy.try_shutdown()


if __name__ == '__main__':
    main()
''',
    "solutions/doubler/mistakes.md": """## says_nothing

It publishes nothing.

```diff
-            self.publisher.publish(Float64(data=2 * message.data))
+            pass
```

Caught by: test_publishes

## adds_two

It adds two.

```diff
-            self.publisher.publish(Float64(data=2 * message.data))
+            self.publisher.publish(Float64(data=2 + message.data))
```

Caught by: test_twice_the_number

## twice

It says it twice.

Breaks: “publishes twice each number on /doubled, once.”

```diff
             self.publisher.publish(Float64(data=2 * message.data))
+            self.publisher.publish(Float64(data=2 * message.data))
```

Caught by: test_once

## another_name

The node has another name.

```diff
-        super().__init__('doubler')
+        super().__init__('dubler')
```

Caught by: test_is_called_doubler

## no_end

It does not catch Ctrl-C.

```diff
-    except (KeyboardInterrupt, ExternalShutdownException):
+    except ExternalShutdownException:
```

Caught by: test_ends_on_ctrl_c

## any_number

It doubles negative numbers, too.

```diff
-        if message.data >= 0:
+        if message.data > -100:
```

Caught by: test_nothing_below_zero

## on_the_input

It has a publisher on /numbers.

```diff
         self.publisher = self.create_publisher(Float64, '/doubled', 10)
+        self.create_publisher(Float64, '/numbers', 10)
```

Caught by: test_leaves_other_topics_alone
""",
}


@dataclass(frozen=True)
class SmallExercise:
    """The exercise `doubler` in a course's folder, to spoil."""

    course: Path

    @property
    def folder(self) -> Path:
        """The exercise's folder."""
        return self.course / "exercises" / "doubler"

    def change(self, file: str, old: str, new: str) -> None:
        """Replace `old` by `new` in a file, given by its path in the course."""
        path = self.course / file
        text = path.read_text(encoding="utf-8")
        assert old in text
        path.write_text(text.replace(old, new), encoding="utf-8")


def written(course: Path) -> SmallExercise:
    """Return the exercise, written into this folder with its solution and its mistakes."""
    for name, text in FILES.items():
        file = course / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")
    return SmallExercise(course)
