"""Quality of service over the middleware, in the hub's time: deadlines, liveliness, lifespan, late joiners, depth."""

from __future__ import annotations

from programs import Watch, serialized

from rmw_lockstep.hub import QosPolicies
from rmw_lockstep.qos import TRANSIENT_LOCAL


def test_a_missed_deadline_is_told_to_both_ends_at_the_time_at_which_it_is_missed(watch: Watch) -> None:
    watch.start("""
        from rclpy.duration import Duration
        from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
        qos = QoSProfile(depth=10, deadline=Duration(nanoseconds=100_000_000))
        late = node.create_publisher(String, '/late', qos, event_callbacks=PublisherEventCallbacks(
            deadline=lambda event: say(f'offered {event.total_count}')))
        node.create_subscription(String, '/late', lambda message: None, qos,
            event_callbacks=SubscriptionEventCallbacks(deadline=lambda event: say(f'requested {event.total_count}')))
        late.publish(String())
        rclpy.spin(node)
    """)
    watch.go_on(0.25)
    assert sorted(watch.said()) == [(100, "offered 1"), (100, "requested 1"), (200, "offered 2"), (200, "requested 2")]


def test_a_publisher_that_does_not_say_that_it_is_alive_is_lost_after_its_lease(watch: Watch) -> None:
    watch.start("""
        from rclpy.duration import Duration
        from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
        qos = QoSProfile(depth=10, liveliness=LivelinessPolicy.MANUAL_BY_TOPIC,
            liveliness_lease_duration=Duration(nanoseconds=100_000_000))
        alive = node.create_publisher(String, '/alive', qos, event_callbacks=PublisherEventCallbacks(
            liveliness=lambda event: say(f'lost {event.total_count}')))
        node.create_subscription(String, '/alive', lambda message: None, qos,
            event_callbacks=SubscriptionEventCallbacks(
                liveliness=lambda event: say(f'alive {event.alive_count}, not {event.not_alive_count}')))
        timer = node.create_timer(0.05, lambda: (alive.assert_liveliness(), timer.cancel()))
        rclpy.spin(node)
    """)
    watch.go_on(1)
    assert watch.said()[:1] == [(50, "alive 1, not 0")]
    assert sorted(watch.said()[1:]) == [(150, "alive 0, not 1"), (150, "lost 1")]


def test_a_message_older_than_its_lifespan_is_not_delivered(watch: Watch) -> None:
    watch.start("""
        from rclpy.duration import Duration
        qos = QoSProfile(depth=10, lifespan=Duration(nanoseconds=100_000_000))
        short = node.create_publisher(String, '/short', qos)
        node.create_subscription(String, '/short', lambda message: say(message.data), 10)
        short.publish(String(data='old'))
        time.sleep(0.2)
        short.publish(String(data='new'))
        rclpy.spin(node)
    """)
    watch.go_on(1)
    assert watch.said() == [(200, "new")]


def test_a_late_subscription_gets_what_a_transient_local_publisher_has_kept(watch: Watch) -> None:
    watch.start("""
        qos = QoSProfile(depth=2, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        lasting = node.create_publisher(String, '/lasting', qos)
        for word in ('one', 'two', 'three'): lasting.publish(String(data=word))
        node.create_subscription(String, '/lasting', lambda message: say(message.data), qos)
        node.create_subscription(String, '/lasting', lambda message: say('volatile ' + message.data), 10)
        rclpy.spin(node)
    """)
    watch.go_on(0)
    assert [said for _, said in watch.said()] == ["two", "three"]


def test_another_process_that_joins_late_gets_it_too(watch: Watch) -> None:
    watch.start("""
        qos = QoSProfile(depth=5, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        lasting = node.create_publisher(String, '/lasting', qos)
        lasting.publish(String(data='kept'))
        rclpy.spin(node)
    """)
    watch.go_on(0.1)
    watch.start("""
        qos = QoSProfile(depth=5, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        node.create_subscription(String, '/lasting', lambda message: say(message.data), qos)
        rclpy.spin(node)
    """)
    watch.go_until(lambda: watch.said())
    assert [said for _, said in watch.said()] == ["kept"]


def test_ends_that_do_not_match_are_not_connected_and_both_are_reported_the_policy(watch: Watch) -> None:
    watch.start("""
        from rclpy.event_handler import PublisherEventCallbacks, SubscriptionEventCallbacks
        policy = lambda end: lambda event: say(f'{end} {event.last_policy_kind.name}')
        modest = node.create_publisher(String, '/x', QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT),
            event_callbacks=PublisherEventCallbacks(incompatible_qos=policy('offered')))
        node.create_subscription(String, '/x', lambda message: say('heard'), 10,
            event_callbacks=SubscriptionEventCallbacks(incompatible_qos=policy('requested')))
        modest.publish(String())
        rclpy.spin(node)
    """)
    watch.go_on(0.1)
    assert sorted(said for _, said in watch.said()) == [
        f"{end} RMW_QOS_POLICY_RELIABILITY" for end in ("offered", "requested")
    ]


def test_a_queue_keeps_the_newest_messages_as_deep_as_it_is(watch: Watch) -> None:
    watch.start("""
        node.create_subscription(String, '/many', lambda message: say(message.data), 3)
        many = node.create_publisher(String, '/many', 100)
        for i in range(10): many.publish(String(data=str(i)))
        rclpy.spin(node)
    """)
    watch.go_on(0)
    assert [said for _, said in watch.said()] == ["7", "8", "9"]


LASTING = QosPolicies(depth=10, durability=TRANSIENT_LOCAL)


def test_a_late_subscription_gets_what_is_on_its_way_once_and_in_order(watch: Watch) -> None:
    lasting = watch.node.publisher("/lasting", "std_msgs/msg/String", LASTING)
    begin = watch.node.publisher("/begin", "std_msgs/msg/String", QosPolicies())
    watch.start("""
        qos = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        heard = lambda message: say(message.data)
        def subscribe(message): node.create_subscription(String, '/lasting', heard, qos)
        node.create_subscription(String, '/begin', subscribe, 10)
        node.create_subscription(String, '/lasting', lambda message: None, 10)
        rclpy.spin(node)
    """)
    watch.go_on(0)
    lasting.publish(serialized("before"))
    watch.hub.wait_until_idle()
    begin.publish(serialized(""))
    watch.hub.barrier()
    lasting.publish(serialized("on its way"))
    watch.go_on(0)
    lasting.publish(serialized("after"))
    watch.go_on(0)
    assert [said for _, said in watch.said()] == ["before", "on its way", "after"]


def test_a_late_subscription_of_another_process_gets_each_message_once_and_in_order(watch: Watch) -> None:
    begin = watch.node.publisher("/begin", "std_msgs/msg/String", QosPolicies())
    qos = "qos = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)"
    watch.start(f"""
        {qos}
        lasting = node.create_publisher(String, '/lasting', qos)
        lasting.publish(String(data='before'))
        node.create_subscription(String, '/begin', lambda message: lasting.publish(String(data='meanwhile')), 10)
        rclpy.spin(node)
    """)
    watch.go_on(0.1)
    watch.start(f"""
        {qos}
        def subscribe(message):
            if message.data == 'late': node.create_subscription(String, '/lasting', lambda m: say(m.data), qos)
        node.create_subscription(String, '/begin', subscribe, 10)
        node.create_subscription(String, '/lasting', lambda message: None, 10)
        rclpy.spin(node)
    """)
    watch.go_until(lambda: len(begin.matched) == 2)
    begin.publish(serialized("late"))
    watch.go_on(0)
    begin.publish(serialized("again"))
    watch.go_on(0)
    assert [said for _, said in watch.said()] == ["before", "meanwhile", "meanwhile"]


def test_a_subscription_gets_what_a_later_publisher_has_to_say(watch: Watch) -> None:
    watch.start("""
        qos = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        node.create_subscription(String, '/lasting', lambda message: say(message.data), qos)
        rclpy.spin(node)
    """)
    watch.go_on(0)
    lasting = watch.node.publisher("/lasting", "std_msgs/msg/String", LASTING)
    lasting.publish(serialized("one"))
    watch.start("""
        qos = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        lasting = node.create_publisher(String, '/lasting', qos)
        lasting.publish(String(data='two'))
        rclpy.spin(node)
    """)
    watch.go_until(lambda: len(watch.said()) > 1)
    assert [said for _, said in watch.said()] == ["one", "two"]
