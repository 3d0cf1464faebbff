"""Prints the results for profiles of quality of service, and which endpoints match and get events of it."""

import time
from collections.abc import Callable

import rclpy
from rclpy.duration import Duration
from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
from rclpy.qos import DurabilityPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy, qos_check_compatible
from std_msgs.msg import String


def profile(**policies: object) -> QoSProfile:
    return QoSProfile(depth=3, **policies)


SECOND, TWO = Duration(seconds=1), Duration(seconds=2)
PROFILES = [
    profile(),
    profile(reliability=ReliabilityPolicy.BEST_EFFORT),
    profile(reliability=ReliabilityPolicy.SYSTEM_DEFAULT),
    profile(durability=DurabilityPolicy.TRANSIENT_LOCAL),
    profile(durability=DurabilityPolicy.SYSTEM_DEFAULT),
    profile(deadline=SECOND),
    profile(deadline=TWO),
    profile(liveliness=LivelinessPolicy.AUTOMATIC),
    profile(liveliness=LivelinessPolicy.MANUAL_BY_TOPIC),
    profile(liveliness_lease_duration=SECOND),
    profile(liveliness_lease_duration=TWO),
]
for publisher in PROFILES:
    for subscription in PROFILES:
        print(*qos_check_compatible(publisher, subscription))

rclpy.init()
node = rclpy.create_node("quality")


def tell(what: str, heard: list[str]) -> object:
    names = ("total_count", "total_count_change", "current_count", "current_count_change", "last_policy_kind")
    return lambda info: heard.append(f"{what} {[str(getattr(info, name, None)) for name in names]}")


def meet(offered: QoSProfile, requested: QoSProfile, topic: str) -> list[str]:
    heard: list[str] = []
    callbacks = PublisherEventCallbacks(incompatible_qos=tell("publisher", heard), matched=tell("p matched", heard))
    publisher = node.create_publisher(String, topic, offered, event_callbacks=callbacks)
    publisher.publish(String(data="early"))
    callbacks = SubscriptionEventCallbacks(
        incompatible_qos=tell("subscription", heard), matched=tell("s matched", heard)
    )
    got = lambda message: heard.append(f"got {message.data}")  # noqa: E731
    node.create_subscription(String, topic, got, requested, event_callbacks=callbacks)
    wait_for(lambda: sum(not text.startswith("got") for text in heard) >= 2)
    publisher.publish(String(data="late"))
    if any(text.startswith("s matched") for text in heard):
        wait_for(lambda: "got late" in heard)
    rclpy.spin_once(node, timeout_sec=0.1)
    return sorted(heard)


def wait_for(happened: Callable[[], bool]) -> None:
    until = time.monotonic() + 60
    while not happened() and time.monotonic() < until:
        rclpy.spin_once(node, timeout_sec=0.1)


PAIRS = [(0, 0), (1, 0), (0, 1), (0, 3), (3, 3), (3, 0), (6, 5), (0, 5), (7, 8), (10, 9)]
for number, (offered, requested) in enumerate(PAIRS):
    print(offered, requested, meet(PROFILES[offered], PROFILES[requested], f"topic{number}"))
