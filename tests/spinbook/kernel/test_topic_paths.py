"""rqt_plot's way to name what to plot."""

from __future__ import annotations

import pytest

from spinbook.kernel.plot.quantity import TopicPath, resolve

TOPICS = ["/a", "/a/b", "/turtle1/cmd_vel"]


@pytest.mark.parametrize(
    ("path", "expected"),
    [
        ("/a/position[0]", TopicPath("/a", ("position", 0))),
        ("a/position[0]", TopicPath("/a", ("position", 0))),
        ("/a/b/position", TopicPath("/a/b", ("position",))),
        ("/a", TopicPath("/a", ())),
        ("/turtle1/cmd_vel/linear/x", TopicPath("/turtle1/cmd_vel", ("linear", "x"))),
        ("/turtle1/cmd_vel.linear.x", TopicPath("/turtle1/cmd_vel", ("linear", "x"))),
        ("/a/matrix[1][2]", TopicPath("/a", ("matrix", 1, 2))),
        ("/ab/x", None),
    ],
)
def test_the_longest_topic_that_fits_is_meant(path: str, expected: TopicPath | None) -> None:
    assert resolve(path, TOPICS) == expected


@pytest.mark.parametrize("path", ["/a/position[", "/a/position[x]", "/a/1st"])
def test_what_is_no_field_is_refused(path: str) -> None:
    with pytest.raises(ValueError, match="is not a field"):
        resolve(path, TOPICS)
