"""What a student reads when the hub stops a program."""

from __future__ import annotations

from rmw_lockstep.hub import Violation

_STORIES = {
    "message": "Your node published a message of {found:,} bytes. At most {limit:,} are allowed.",
    "bytes": "Your node published more than {limit:,} bytes in one scenario.",
    "messages": "Your node sent more than {limit:,} messages in one scenario.",
    "nodes": "Your program created more than {limit:,} nodes.",
    "end points": "Your program created more than {limit:,} publishers, subscriptions, clients and services.",
    "connections": "Your program started more than {limit:,} processes.",
    "unread": "Your program does not take the messages that are sent to it: {found:,} bytes are waiting for it.",
    "wake-ups": "Your program woke up more than {limit:,} times in one scenario. Does a loop wait for no time at all?",
    "frames": "Your program changed the ROS graph, or fell asleep, more than {limit:,} times in one scenario.",
    "protocol": "Your program disturbed the connection between ROS 2 and the grader: {text}.",
}


def story_of(violation: Violation) -> str:
    """Return one sentence for the student."""
    story = _STORIES[violation.reason]
    return story.format(found=violation.found, limit=violation.limit, text=violation.text)
