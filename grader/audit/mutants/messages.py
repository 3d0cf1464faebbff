"""Operators for messages: their stamp, frame, units and order, and where they are published."""

from __future__ import annotations

from collections.abc import Iterator

import libcst as cst

from grader.audit.mutants.program import (
    Change,
    ParsedProgram,
    called,
    expression,
    only_assignment,
    only_call,
    with_body,
)
from grader.exercise.exercise import ServiceOrAction, Topic

NODE_CLOCK = "self.get_clock().now().to_msg()"
WALL_CLOCK = "rclpy.clock.Clock().now().to_msg()"


def other_clock(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Use the node's clock or the computer's instead of a message's stamp."""
    if isinstance(node, cst.Attribute) and program.text(node).endswith(".header.stamp"):
        if isinstance(program.parent(node), cst.AssignTarget):
            return
        if program.has_self(node):
            yield Change(node, node, expression(NODE_CLOCK), "takes the node's clock for the stamp")
        yield Change(node, node, expression(WALL_CLOCK), "takes the computer's clock for the stamp", ("rclpy.clock",))


def part_of_stamp(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Use sec instead of nanosec, and the reverse."""
    if isinstance(node, cst.Attribute) and node.attr.value in ("sec", "nanosec"):
        other = "nanosec" if node.attr.value == "sec" else "sec"
        yield Change(node, node.attr, cst.Name(other), f"takes {other} for {node.attr.value}")


def header(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """When a header is copied, drop the stamp or the frame, or stamp with the current time."""
    assignment = only_assignment(node)
    if assignment is None:
        return
    target, value = program.text(assignment.targets[0].target), program.text(assignment.value)
    if target.endswith(".header") and value.endswith(".header"):
        yield program.instead(node, "drops the stamp", f"{target}.frame_id = {value}.frame_id")
        yield program.instead(node, "drops the frame", f"{target}.stamp = {value}.stamp")
        if program.has_self(node):
            now = f"{target}.stamp = {NODE_CLOCK}"
            yield program.instead(node, "stamps with the node's clock", node, now)


def unit(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Give a field that has a unit in degrees, or in thousandths."""
    declared: tuple[Topic | ServiceOrAction, ...] = (*program.exercise.outputs, *program.exercise.endpoints)
    fields = {field for topic in declared for field in topic.units}
    value: cst.BaseExpression | None = None
    field = ""
    if isinstance(node, cst.Call) and called(node) == "append" and len(node.args) == 1:
        field, value = program.text(node.func).split(".")[-2], node.args[0].value
        templates = ("math.degrees({})", "({}) * 1000.0")
    elif isinstance(node, cst.Arg) and node.keyword is not None:
        field, value = node.keyword.value, node.value
        templates = _EACH
    elif isinstance(node, cst.Assign) and isinstance(node.targets[0].target, cst.Attribute):
        field, value = node.targets[0].target.attr.value, node.value
        templates = _EACH
    if value is not None and field in fields:
        text = program.text(value)
        for template, description in zip(templates, ("in degrees", "in thousandths"), strict=True):
            yield Change(node, value, expression(template.format(text)), f"gives {field} {description}", ("math",))


_EACH = ("[math.degrees(v) for v in {}]", "[v * 1000.0 for v in {}]")


def before_publishing(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Change the message before it is published: its stamp, frame or order, or one entry too few or too many."""
    call = only_call(node, "publish")
    if call is None or not call.args or not isinstance(call.args[0].value, cst.Name):
        return
    name = call.args[0].value.value
    lists = _lists(program, name)
    if lists:
        all_reversed = "; ".join(f"{name}.{field}.reverse()" for field in lists)
        yield program.instead(node, "publishes everything in the reverse order", all_reversed, node)
        for field in lists:
            yield program.instead(node, f"publishes {field} in the reverse order", f"{name}.{field}.reverse()", node)
            yield program.instead(node, f"publishes one {field} too few", f"{name}.{field}.pop()", node)
            yield program.instead(node, f"publishes no {field}", f"{name}.{field} = []", node)
    if any(topic.type.endswith("JointState") for topic in program.exercise.outputs):
        yield program.instead(node, "publishes positions, too", f"{name}.position = [0.0] * len({name}.name)", node)
    yield program.instead(node, "publishes an empty message", f"{name} = type({name})()", node)


def _lists(program: ParsedProgram, name: str) -> list[str]:
    """Return the fields of the message `name` that are appended to or assigned."""
    fields: dict[str, None] = {}
    for node in program.nodes():
        if isinstance(node, cst.Call) and called(node) == "append":
            parts = program.text(node.func).split(".")
            if len(parts) == 3 and parts[0] == name:
                fields[parts[1]] = None
    return list(fields)


def publishing(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Publish in the wrong place: in the loop, before the message is filled, without its guard, every second time."""
    call = only_call(node, "publish")
    if call is None:
        return
    text = program.text(node.with_changes(leading_lines=[])).strip()
    if program.has_self(node):
        turn = "self.turn = not getattr(self, 'turn', False)"
        yield program.instead(node, "publishes every second time", turn, f"if self.turn:\n    {text}\n")
    function = program.function(node)
    if function is None or not isinstance(function.body, cst.IndentedBlock):
        return
    for other in program.nodes():
        if program.function(other) is not function or program.line(other) >= program.line(node):
            continue
        if isinstance(other, cst.For) and isinstance(other.body, cst.IndentedBlock):
            body = [*other.body.body, cst.parse_statement(text)]
            yield Change(other, other.body, with_body(other.body, body), "publishes inside the loop, too")
        assignment = only_assignment(other)
        if assignment is not None and call.args:
            target = program.text(assignment.targets[0].target)
            if target == program.text(call.args[0].value):
                yield program.instead(other, "publishes before the message is filled, too", other, text)


OPERATORS = (other_clock, part_of_stamp, header, unit, before_publishing, publishing)
