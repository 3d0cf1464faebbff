"""Images and maps: their bytes are given as they are in rclpy, kept in few bytes, and seen by checks as lists."""

from __future__ import annotations

import json
from array import array
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, ClassVar

import numpy as np
import pytest
from runner_programs import EXERCISE
from test_msgs.msg import BasicTypes, UnboundedSequences

from grader.checking.comparator import difference, shown
from grader.exercise import ExerciseError
from grader.exercise.exercise import Topic
from grader.recording import Recording
from grader.recording.arrays import LongArray
from grader.recording.recording import from_json, to_json
from grader.report.bag import write_bags
from grader.runner.message import filled, to_fields
from grader.runner.program import Task
from grader.runner.run import run
from grader.sandbox import ForkServer, Limits, ProgramSpec, SandboxedProgram, choose
from grader.scenario import Scenario, World, at
from grader.scenario.command_line import ARGUMENTS
from grader.scenario.resolver import resolved
from grader.scenario.values import checked_fields
from grader.workers.pool import STUDENT_ENVIRONMENT

IMAGE, GRID = "sensor_msgs/msg/Image", "nav_msgs/msg/OccupancyGrid"
TOPICS = (Topic("/image", IMAGE, "subscribe"), Topic("/mirrored", IMAGE, "publish"))
CAMERA = replace(EXERCISE, name="camera", topics=TOPICS)

MIRROR = """
import rclpy
from rclpy.node import Node
from sensor_msgs.msg import Image

class Mirror(Node):
    def __init__(self):
        super().__init__('mirror')
        self.publisher = self.create_publisher(Image, '/mirrored', 10)
        self.create_subscription(Image, '/image', self.on_image, 10)

    def on_image(self, image):
        image.data = bytes(reversed(image.data))
        self.publisher.publish(image)

rclpy.init()
rclpy.spin(Mirror())
"""

WIDTH, HEIGHT = 320, 240
PICTURE = bytes(x * y // 64 % 256 for y in range(HEIGHT) for x in range(WIDTH) for _ in range(3))


def image(data: Any) -> dict[str, Any]:
    return {"width": WIDTH, "height": HEIGHT, "encoding": "rgb8", "step": 3 * WIDTH, "data": data}


def images(*data: Any) -> Scenario:
    messages = (at(0.1 * number).publish("/image", **image(one)) for number, one in enumerate(data))
    return Scenario("images", "Images", tuple(messages))


class Camera:
    """A world that publishes an image in each step."""

    reads: ClassVar[dict[str, str]] = {}
    publishes: ClassVar = {"/image": IMAGE}

    def hear(self, topic: str, message: Any) -> None:
        """Hear nothing."""

    def step(self, seconds: float) -> None:
        """Do nothing."""

    def state(self) -> dict[str, Any]:
        return {"/image": image(bytearray(PICTURE))}


@pytest.fixture(scope="module")
def recording(fork_server: ForkServer) -> Recording:
    """Twenty images, and what the node makes of them."""
    return mirrored(fork_server, images(*(PICTURE[i:] + PICTURE[:i] for i in range(20))))


def mirrored(fork_server: ForkServer, scenario: Scenario) -> Recording:
    scenario = resolved(CAMERA, scenario)

    def start(hub: int) -> SandboxedProgram:
        program = ProgramSpec("node.py", {"node.py": MIRROR.encode()}, ARGUMENTS, STUDENT_ENVIRONMENT, hub=hub)
        return fork_server.start(program, choose(None), Limits())

    found = run(Task(CAMERA, scenario, "node.py", MIRROR), start)
    assert found.ending.outcome == "completed", found.log
    return found


def test_a_node_gets_and_sends_images_as_it_does_over_dds(recording: Recording) -> None:
    assert [len(one.fields["data"]) for one in recording.received] == [len(PICTURE)] * 20
    assert recording.received[0].fields["data"] == list(reversed(PICTURE))
    assert recording.sent[0].fields["data"] == list(PICTURE)


def test_a_world_publishes_bytes_too(fork_server: ForkServer) -> None:
    found = mirrored(fork_server, Scenario("world", "World", world=World(Camera, period=0.5), duration=1.0))
    assert [one.fields["data"] == list(reversed(PICTURE)) for one in found.received] == [True, True]


def test_twenty_images_take_less_than_a_megabyte_and_are_read_as_they_were(recording: Recording) -> None:
    text = to_json({"images": recording})
    assert len(text) < 1_000_000
    assert from_json(text) == {"images": recording}


def test_the_same_array_is_written_once(recording: Recording) -> None:
    first, second = recording.sent[:2]
    again = replace(recording, received=(), sent=(first, second, first, first))
    once = replace(recording, received=(), sent=(first, second))
    assert len(to_json({"images": again})) < len(to_json({"images": once})) + 1_000
    assert from_json(to_json({"images": again})) == {"images": again}


def test_a_recording_with_whole_lists_is_still_read(recording: Recording) -> None:
    first = replace(recording, received=(), sent=recording.sent[:1])
    entries = json.loads(to_json({"images": first}))
    entries["images"]["sent"][0]["fields"]["data"] = list(PICTURE)
    assert from_json(json.dumps(entries)) == {"images": first}


def test_a_bag_has_the_images(recording: Recording, tmp_path: Path) -> None:
    from rosbags.highlevel import AnyReader

    grade = SimpleNamespace(recordings={"images": recording}, references={"images": recording})
    [bag] = write_bags(grade, tmp_path)  # type: ignore[arg-type]
    with AnyReader([bag]) as reader:
        raw = [(raw, c.msgtype) for c, _, raw in reader.messages() if c.topic == "/mirrored"]
        image: Any = reader.deserialize(*raw[0])
    assert image.data.tobytes() == bytes(reversed(PICTURE))


@pytest.mark.parametrize(
    "data",
    [
        PICTURE,
        bytearray(PICTURE),
        memoryview(PICTURE),
        array("B", PICTURE),
        np.frombuffer(PICTURE, dtype=np.uint8),
        list(PICTURE),
    ],
    ids=lambda data: type(data).__name__,
)
def test_an_image_is_given_as_whatever_rclpy_takes(data: Any) -> None:
    [message] = resolved(CAMERA, images(data)).messages
    assert type(message.fields["data"]) is LongArray
    assert message.fields["data"] == list(PICTURE)
    assert resolved(CAMERA, images(data)).digest == resolved(CAMERA, images(PICTURE)).digest


def test_a_short_array_is_a_list_whatever_it_is_given_as() -> None:
    for data in (b"\1\2", np.array([1, 2], dtype=np.uint8), [1, 2]):
        [message] = resolved(CAMERA, images(data)).messages
        assert type(message.fields["data"]) is list
        assert message.fields["data"] == [1, 2]


@pytest.mark.parametrize(
    ("data", "problem"),
    [
        ([0] * 999 + [256], r"256 \(int\) is given for data\[999\]"),
        ([0] * 999 + [1.0], r"1.0 \(float\) is given for data\[999\]"),
        (np.zeros(300), r"0.0 \(float\) is given for data\[0\]"),
        ("text", "Write a list"),
    ],
)
def test_what_is_no_byte_is_named_with_its_place(data: Any, problem: str) -> None:
    with pytest.raises(ExerciseError, match=problem):
        resolved(CAMERA, images(data))


def test_a_map_with_signed_bytes_is_kept_as_few_bytes_too() -> None:
    cells = [-1, 0, 100] * 1_000
    maps = Scenario("maps", "Maps", (at(0.0).publish("/map", GRID, data=array("b", cells)),))
    [message] = resolved(replace(CAMERA, topics=(*TOPICS, Topic("/map", GRID, "subscribe"))), maps).messages
    assert message.fields["data"] == cells
    assert message.fields["data"].itemsize == 1


def test_a_check_compares_and_shows_arrays_as_lists() -> None:
    mine, its = LongArray("B", PICTURE), LongArray("B", PICTURE)
    assert difference(mine, its) is None
    assert difference(mine, list(PICTURE)) is None
    mine[1_000] = (mine[1_000] + 1) % 256
    found = difference({"data": mine}, {"data": its})
    assert found
    assert (found.path, found.expected) == ("data[1000]", PICTURE[1_000])
    assert shown(mine) == shown(list(PICTURE))
    assert mine[:3] == list(PICTURE[:3])
    assert mine != its


def test_a_byte_and_bytes_are_numbers_in_a_recording() -> None:
    message = UnboundedSequences(byte_values=[b"\1", b"\xff"])
    assert to_fields(message)["byte_values"] == [1, 255]
    assert filled(UnboundedSequences(), {"byte_values": [1, 255]}).byte_values == [b"\1", b"\xff"]
    assert to_fields(BasicTypes(byte_value=b"\7"))["byte_value"] == 7
    assert filled(BasicTypes(), {"byte_value": 7}).byte_value == b"\7"
    given = checked_fields(UnboundedSequences, {"byte_values": b"\1\2", "float32_values": np.zeros(2)}, "name")
    assert given == {"byte_values": [1, 2], "float32_values": [0.0, 0.0]}
