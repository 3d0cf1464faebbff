"""Prints what a program with most entities does: topics, a service, an action, parameters, timers, the graph."""

import rclpy
from rcl_interfaces.srv import GetParameters
from rclpy.action import ActionClient, ActionServer, CancelResponse
from rclpy.action.graph import get_action_names_and_types
from rclpy.clock import Clock, ClockType
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import Parameter
from rclpy.qos import QoSProfile
from std_msgs.msg import Float64
from std_srvs.srv import SetBool
from test_msgs.action import Fibonacci

ARGS = [
    "--ros-args",
    "-p",
    "rate:=5",
    "-p",
    "name:='5'",
    "-p",
    "list:=[1.5, 2.0]",
    "-p",
    "on:=true",
    "-p",
    "word:=left",
]
rclpy.init(args=[*ARGS, "-p", "server:limit:=3", "-p", "exp:=1e3"])
server = rclpy.create_node("server", automatically_declare_parameters_from_overrides=True)
client = rclpy.create_node("client", namespace="/ns", allow_undeclared_parameters=True)
executor = SingleThreadedExecutor()
executor.add_node(server)
executor.add_node(client)
for name, parameter in sorted(server._parameters.items()):
    if name != "start_type_description_service":
        print(name, parameter.type_, parameter.value)


def until(done: object) -> None:
    for _ in range(3000):
        if done():
            return
        executor.spin_once(timeout_sec=0.02)
    print("it never came")


heard = []
server.create_subscription(Float64, "numbers", lambda message: heard.append(message.data), QoSProfile(depth=2))
publisher = client.create_publisher(Float64, "/numbers", 10)
until(lambda: publisher.get_subscription_count() == 1)
for number in range(4):
    publisher.publish(Float64(data=float(number)))
until(lambda: len(heard) >= 2)
print("a queue of two kept", heard[-1], publisher.topic_name)


def switch(request: SetBool.Request, response: SetBool.Response) -> SetBool.Response:
    response.success, response.message = request.data, "switched"
    return response


server.create_service(SetBool, "~/switch", switch)
caller = client.create_client(SetBool, "/server/switch")
print("ready", caller.wait_for_service(timeout_sec=60.0))
future = caller.call_async(SetBool.Request(data=True))
until(future.done)
print(future.result())

asking = client.create_client(GetParameters, "/server/get_parameters")
asking.wait_for_service(timeout_sec=60.0)
future = asking.call_async(GetParameters.Request(names=["rate", "list", "absent"]))
until(future.done)
print([value.type for value in future.result().values])
print(client.set_parameters([Parameter("any", value=[True, False])])[0].successful, client.get_parameter("any").value)


def count(goal: object) -> Fibonacci.Result:
    for n in range(goal.request.order):
        goal.publish_feedback(Fibonacci.Feedback(sequence=[n]))
    if goal.is_cancel_requested:
        goal.canceled()
    else:
        goal.succeed()
    return Fibonacci.Result(sequence=list(range(goal.request.order)))


waiting = []
worker = ActionServer(
    server, Fibonacci, "count", count, handle_accepted_callback=waiting.append,
    cancel_callback=lambda goal: CancelResponse.ACCEPT,
)  # fmt: skip
sender = ActionClient(client, Fibonacci, "/count")
print("server there", sender.wait_for_server(timeout_sec=60.0))
for canceled in (False, True):
    feedback = []
    sent = sender.send_goal_async(
        Fibonacci.Goal(order=3),
        feedback_callback=lambda message, into=feedback: into.append(list(message.feedback.sequence)),
    )
    until(sent.done)
    handle = sent.result()
    if canceled:
        asked = handle.cancel_goal_async()
        until(asked.done)
        print("canceling", asked.result().return_code, len(asked.result().goals_canceling))
    waiting.pop().execute()
    until(lambda got=feedback: len(got) == 3)
    result = handle.get_result_async()
    until(result.done)
    print(handle.accepted, result.result().status, list(result.result().result.sequence), feedback)
    asked = handle.cancel_goal_async()
    until(asked.done)
    print("too late", asked.result().return_code)

ticks = []
timer = server.create_timer(0.01, lambda: ticks.append(timer.time_since_last_call() < 10**9))
until(lambda: len(ticks) == 3)
timer.cancel()
print(ticks, timer.is_canceled(), timer.time_until_next_call(), Clock(clock_type=ClockType.STEADY_TIME).now() > Clock(
    clock_type=ClockType.STEADY_TIME).now())  # fmt: skip

seen = sorted(client.get_node_names_and_namespaces())
print(seen, client.get_topic_names_and_types(), client.get_service_names_and_types(), sep="\n")
print([found for found in client.get_topic_names_and_types(no_demangle=True) if found[0] == "rt/numbers"])
print(get_action_names_and_types(client))
for info in client.get_publishers_info_by_topic("/numbers") + client.get_subscriptions_info_by_topic("/numbers"):
    print(
        info.node_name, info.node_namespace, info.topic_type, info.topic_type_hash, info.endpoint_type, info.qos_profile
    )
for name, space in [("server", "/"), ("client", "/ns")]:
    for what in ("publisher", "subscriber", "service", "client"):
        print(name, what, getattr(client, f"get_{what}_names_and_types_by_node")(name, space))
print(client.count_publishers("/numbers"), client.count_subscribers("/numbers"))
client.get_logger().info("said once", once=True)
rclpy.shutdown()
try:
    rclpy.shutdown()
except RuntimeError as error:
    print(type(error).__name__, error)
