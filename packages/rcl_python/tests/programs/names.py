"""Prints the results for names: which are valid, how they expand, how they are remapped."""

import rclpy
from rclpy.impl.implementation_singleton import rclpy_implementation as module

NAMES = [
    "", "a", "/a", "a/", "a//b", "/a//b", "1a", "a/1b", "/1b", "~a", "~/a", "~", "~foo", "a~b", "/~", "{a", "a}",
    "{a b}", "{1}", "{node}", "{{a}}", "/a/{sub}", "a b", "/a b", "__a", "a__b", "/", "/a/", "x" * 300, "/" + "x" * 300,
    "a-b",
    "ä",
]  # fmt: skip
EXPANDED = ["a", "~/a", "~", "{node}/x", "{ns}/x", "{namespace}/x", "{foo}/x", "/b", "b//", "{ns}{node}"]


def said(function: object, *given: object) -> object:
    try:
        return function(*given)
    except Exception as error:
        return f"{type(error).__name__}: {error}"


for name in NAMES:
    print(repr(name[:20]))
    for kind in ("topic_name", "full_topic_name", "namespace", "node_name"):
        print("   ", kind, said(getattr(module, f"rclpy_get_validation_error_for_{kind}"), name))
for name in EXPANDED:
    for node, namespace in [("n", "/"), ("n", "/ns"), ("1n", "/ns"), ("n", "ns")]:
        print(name, node, namespace, said(module.rclpy_expand_topic_name, name, node, namespace))

rules = ["a:=b", "/c:=/d", "__ns:=/space", "__node:=other", "~/mine:=yours", "n:only:=mine", "x:only:=not_mine"]
args = ["--ros-args"]
for rule in [*rules, "rostopic://t:=topics", "rosservice://s:=services"]:
    args += ["-r", rule]
rclpy.init(args=args)
node = rclpy.create_node("n")
print(node.get_fully_qualified_name(), node.get_logger().name)
for name in ["a", "/a", "c", "/c", "~/mine", "only", "t", "s", "free"]:
    print(name, node.resolve_topic_name(name), node.resolve_service_name(name))
    print(name, node.resolve_topic_name(name, only_expand=True))
for name in ["bad name", "", "a//b", "{x}"]:
    for make in (node.create_publisher, node.create_subscription):
        from std_msgs.msg import String

        print(repr(name), said(make, String, name, *([print] if make == node.create_subscription else []), 1))
for name, namespace in [
    ("1x", ""),
    ("a b", ""),
    ("", ""),
    ("x", "1"),
    ("x", "/a//b"),
    ("x", "a b"),
    ("x", "rel/ative"),
]:
    made = said(
        lambda given=(name, namespace): rclpy.create_node(given[0], namespace=given[1], use_global_arguments=False)
    )
    print((name, namespace), made if isinstance(made, str) else made.get_fully_qualified_name())
