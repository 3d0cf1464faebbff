"""While a chapter is built, its node graph is recorded; the chapter itself is not affected."""

from __future__ import annotations

import json
from dataclasses import dataclass

import pytest
from course_folder import CourseFolder
from process_mark import ProcessMark

from spinbook.graph.model import GraphEndpoint, NodeGraph

_NODE = """```python title="{name}.py" seconds=60 until="{until}"
import rclpy
from rclpy.executors import ExternalShutdownException
from std_msgs.msg import Float64, String

rclpy.init()
node = rclpy.create_node("{name}")
{code}
try:
    rclpy.spin(node)
except (KeyboardInterrupt, ExternalShutdownException):
    pass
finally:
    node.destroy_node()
    rclpy.try_shutdown()
```
"""
#: Publishes ten times per second; /unheard never has a subscriber, and it prints how many it sees there.
_TALKER = """
chatter, unheard = node.create_publisher(String, "/chatter", 10), node.create_publisher(String, "/unheard", 10)
said = 0
def speak():
    global said
    said += 1
    chatter.publish(String(data="hello"))
    unheard.publish(String(data="hello"))
    if said == 30: print("said 30, seen on /unheard:", unheard.get_subscription_count(), flush=True)
node.create_timer(0.1, speak)
print("talking", flush=True)
"""
#: Prints a line once it has received enough messages to count their rate.
_LISTENER = """
heard = []
def hear(message):
    heard.append(message)
    if len(heard) == 60: print("heard 60", flush=True)
node.create_subscription(String, "/chatter", hear, 10)
"""
_MISFIT = """
node.create_subscription(Float64, "/chatter", print, 10)
print("waiting", flush=True)
"""
CHAPTER = f"""# One

{_NODE.format(name="talker", until="talking", code=_TALKER)}
{_NODE.format(name="listener", until="heard 60", code=_LISTENER)}
{_NODE.format(name="misfit", until="waiting", code=_MISFIT)}
```bash
ros2 node list
```

```bash
ros2 topic info /chatter
```

```python
%stop misfit
```

```python
%log talker
```
"""


@dataclass(frozen=True)
class Seen:
    """What the chapter's build produced."""

    folder: CourseFolder
    graph: NodeGraph
    outputs: dict[str, str]


@pytest.fixture(scope="module")
def seen(tmp_path_factory: pytest.TempPathFactory) -> Seen:
    """One chapter, built once, and nothing of it is left running."""
    with pytest.MonkeyPatch.context() as patch:
        mark = ProcessMark(patch)
        folder = CourseFolder(tmp_path_factory.mktemp("course")).write(one=CHAPTER)
        said = folder.spinbook("build", "--execute")
        assert said.returncode == 0, said.stdout
        mark.wait_until_none()
    text = (folder.root / "build/executed/one.graph.json").read_text()
    return Seen(folder, NodeGraph.from_json(text), folder.outputs("one"))


def test_every_node_is_there_from_its_first_cell_to_its_last(seen: Seen) -> None:
    assert [(node.name, node.first_cell, node.last_cell) for node in seen.graph.nodes] == [
        ("/talker", "node-talker", "code-one-2"),
        ("/listener", "node-listener", "code-one-2"),
        ("/misfit", "node-misfit", "ros2-topic-info-chatter"),
    ]


def test_a_topic_has_its_ends_and_those_that_do_not_fit_are_told_apart(seen: Seen) -> None:
    (chatter, unheard) = seen.graph.topics
    text, number = "std_msgs/msg/String", "std_msgs/msg/Float64"

    assert chatter.name == "/chatter"
    assert chatter.publishers == (GraphEndpoint("/talker", text, True),)
    assert chatter.subscriptions == (GraphEndpoint("/listener", text, True), GraphEndpoint("/misfit", number, False))
    assert unheard.publishers == (GraphEndpoint("/talker", text, False),)
    assert unheard.subscriptions == ()


def test_a_rate_is_reported_where_somebody_listens(seen: Seen) -> None:
    (chatter, unheard) = seen.graph.topics

    # It is 10, if the machine is not so busy that the timer is late.
    assert chatter.rate_hz is not None
    assert 0 < chatter.rate_hz <= 10
    assert unheard.rate_hz is None


def test_the_chapter_does_not_notice_that_it_is_watched(seen: Seen) -> None:
    assert seen.outputs["ros2-node-list"].split() == ["/listener", "/misfit", "/talker"]
    assert "Subscription count: 2" in seen.outputs["ros2-topic-info-chatter"]
    assert "said 30, seen on /unheard: 0" in seen.outputs["code-one-2"]


def test_the_graph_is_kept_with_the_outputs_of_a_good_run(seen: Seen) -> None:
    file = seen.folder.root / "build/executed/one.graph.json"
    before = file.read_text()
    file.unlink()

    said = seen.folder.spinbook("build", "--execute")

    assert "one: unchanged since its last run" in said.stdout
    assert file.read_text() == before


def test_the_file_tells_no_time_and_no_process(seen: Seen) -> None:
    recorded = json.loads((seen.folder.root / "build/executed/one.graph.json").read_text())

    assert set(recorded) == {"nodes", "topics"}
    assert {key for node in recorded["nodes"] for key in node} == {"name", "first_cell", "last_cell"}
