"""Services, actions and parameters between real programs, through the hub."""

from __future__ import annotations

from programs import Watch

SERVER = """
    from std_srvs.srv import SetBool
    def answer(request, response):
        response.success, response.message = request.data, 'from the server'
        return response
    node.create_service(SetBool, '/switch', answer)
    rclpy.spin(node)
"""


def test_a_service_of_one_process_answers_another_process(watch: Watch) -> None:
    watch.start(SERVER)
    watch.go_on(0)
    watch.start("""
        from std_srvs.srv import SetBool
        client = node.create_client(SetBool, '/switch')
        client.wait_for_service()
        for data in (True, False):
            future = client.call_async(SetBool.Request(data=data))
            rclpy.spin_until_future_complete(node, future)
            say(f'{future.result().success} {future.result().message}')
        rclpy.spin(node)
    """)
    watch.go_until(lambda: len(watch.said()) == 2)
    assert [said for _, said in watch.said()] == ["True from the server", "False from the server"]


def test_an_action_gives_feedback_is_cancelled_and_ends_in_the_hubs_time(watch: Watch) -> None:
    watch.start("""
        from rclpy.action import ActionServer, CancelResponse
        from test_msgs.action import Fibonacci
        def execute(goal):
            sequence = [0, 1]
            for _ in range(goal.request.order):
                if goal.is_cancel_requested:
                    goal.canceled()
                    return Fibonacci.Result(sequence=sequence)
                sequence.append(sequence[-1] + sequence[-2])
                goal.publish_feedback(Fibonacci.Feedback(sequence=sequence))
                time.sleep(0.1)
            goal.succeed()
            return Fibonacci.Result(sequence=sequence)
        ActionServer(node, Fibonacci, 'fibonacci', execute, cancel_callback=lambda goal: CancelResponse.ACCEPT)
        executor = MultiThreadedExecutor()
        executor.add_node(node)
        executor.spin()
    """)
    watch.go_on(0)
    watch.start("""
        from rclpy.action import ActionClient
        from test_msgs.action import Fibonacci
        client = ActionClient(node, Fibonacci, 'fibonacci')
        client.wait_for_server()
        def run(order, cancel_after=None):
            began = time.monotonic()
            future = client.send_goal_async(Fibonacci.Goal(order=order), lambda feedback: None)
            rclpy.spin_until_future_complete(node, future)
            result = future.result().get_result_async()
            if cancel_after:
                rclpy.spin_until_future_complete(node, result, timeout_sec=cancel_after)
                rclpy.spin_until_future_complete(node, future.result().cancel_goal_async())
            rclpy.spin_until_future_complete(node, result)
            say(f'{result.result().status} {list(result.result().result.sequence)} {time.monotonic() - began:.2f}')
        run(3)
        run(10, cancel_after=0.25)
        rclpy.spin(node)
    """)
    watch.go_until(lambda: len(watch.said()) == 2)
    assert [said for _, said in watch.said()] == ["4 [0, 1, 1, 2, 3] 0.30", "5 [0, 1, 1, 2, 3] 0.30"]


def test_what_the_middleware_does_not_do_is_refused_in_words(watch: Watch) -> None:
    watch.start("""
        try:
            node.create_subscription(String, '/x', print, 1, content_filter_options=1)
        except Exception as refused:
            say(type(refused).__name__)
        for topic in ('with space', '/ends/'):
            try: node.create_publisher(String, topic, 1)
            except Exception as refused: say(type(refused).__name__)
        rclpy.spin(node)
    """)
    watch.go_on(0)
    assert [said for _, said in watch.said()] == ["TypeError", "InvalidTopicNameException", "InvalidTopicNameException"]
