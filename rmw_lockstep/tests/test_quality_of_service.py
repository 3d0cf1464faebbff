"""Quality of service over the middleware, in the hub's time: deadlines, liveliness, lifespan, late joiners, depth."""

from __future__ import annotations

from programs import Watch


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


def test_ends_that_do_not_match_are_not_connected_and_both_are_told_the_policy(watch: Watch) -> None:
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
