"""Endpoints of the hub's own carry the hash of their type, as those of programs do."""

from __future__ import annotations

import ast

from programs import Watch

from rmw_lockstep.hub import QosPolicies
from rmw_lockstep.type_hash import NO_HASH, type_hash

STRING = "std_msgs/msg/String"


def test_a_program_sees_the_same_hash_on_the_hubs_endpoints_as_on_its_own(watch: Watch) -> None:
    watch.node.publisher("/same", STRING, QosPolicies())
    watch.start("""
        node.create_publisher(String, '/same', 10)
        def look():
            found = node.get_publishers_info_by_topic('/same')
            say([(one.node_name, one.topic_type_hash.version, one.topic_type_hash.value.hex()) for one in found])
            timer.cancel()
        timer = node.create_timer(0.1, look)
        rclpy.spin(node)
    """)
    watch.go_on(0.2)

    [(_, said)] = watch.said()
    hashes = {name: (version, value) for name, version, value in ast.literal_eval(said)}
    expected = (1, type_hash(STRING)[1:].hex())
    assert hashes == {"talker": expected, "watch": expected}


def test_services_and_parts_of_actions_have_hashes_and_a_type_without_a_description_has_none() -> None:
    known = [type_hash("std_srvs/srv/Trigger"), type_hash("example_interfaces/action/Fibonacci_SendGoal")]

    assert all(one[0] == 1 for one in known)
    assert len(set(known)) == len(known)
    assert type_hash("no_such_package/msg/Thing") == type_hash("std_msgs/msg/NoSuchThing") == NO_HASH
