"""Operators for services, actions and parameters, and for what blocks a node that has them."""

from __future__ import annotations

from collections.abc import Iterator

import libcst as cst

from grader.audit.mutants.program import Change, ParsedProgram, argument, called, expression, with_argument, with_body

#: How a goal ends -> another way to end.
OUTCOMES = {"succeed": ("abort", "canceled"), "canceled": ("succeed", "abort"), "abort": ("succeed",)}

#: A name after a dot -> the name that replaces it.
CHOICES = {
    "ACCEPT": "REJECT",
    "REJECT": "ACCEPT",
    "TRANSIENT_LOCAL": "VOLATILE",
    "VOLATILE": "TRANSIENT_LOCAL",
    "RELIABLE": "BEST_EFFORT",
    "BEST_EFFORT": "RELIABLE",
}

#: What a node asks its peers -> the answer that it assumes without asking.
ASKED = {
    "is_cancel_requested": ("False", "True"),
    "accepted": ("True", "False"),
    "service_is_ready": ("True",),
    "server_is_ready": ("True",),
    "wait_for_service": ("True",),
    "wait_for_server": ("True",),
}

#: A call -> the call that replaces it, and the module that defines that call.
CALLS = {
    "call_async": ("call", ""),
    "MultiThreadedExecutor": ("SingleThreadedExecutor", "rclpy.executors"),
    "ReentrantCallbackGroup": ("MutuallyExclusiveCallbackGroup", "rclpy.callback_groups"),
}

#: The arguments that name callbacks: call -> positions and names of arguments.
CALLBACKS: dict[str, tuple[tuple[int, str], ...]] = {
    "create_subscription": ((2, "callback"),),
    "create_timer": ((1, "callback"),),
    "create_service": ((2, "callback"),),
    "ActionServer": ((3, "execute_callback"), (99, "goal_callback"), (99, "cancel_callback")),
    "add_on_set_parameters_callback": ((0, "callback"),),
    "add_done_callback": ((0, "callback"),),
}


def outcome(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """End a goal in another way."""
    if isinstance(node, cst.Call) and isinstance(node.func, cst.Attribute) and not node.args:
        for other in OUTCOMES.get(called(node), ()):
            yield Change(node, node.func.attr, cst.Name(other), f"calls {other}() for {called(node)}()")


def choice(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Reject a goal or a request to cancel instead of accepting it; use the other policy."""
    if isinstance(node, cst.Attribute) and node.attr.value in CHOICES:
        other = CHOICES[node.attr.value]
        yield Change(node, node.attr, cst.Name(other), f"takes {other} for {node.attr.value}")


def not_asked(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Assume that a goal is canceled or accepted, or that a server is there, without asking."""
    above = program.parent(node)
    is_called = isinstance(above, cst.Call) and above.func is node  # the call itself is handled
    if is_called or isinstance(above, (cst.AssignTarget, cst.Expr)):
        return
    name = node.attr.value if isinstance(node, cst.Attribute) else called(node)
    for answer in ASKED.get(name, ()):
        yield Change(node, node, expression(answer), f"takes {answer} for {name}")


def blocking(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Wait for an answer where the program does not; use one thread instead of several."""
    name = called(node)
    if not isinstance(node, cst.Call) or name not in CALLS:
        return
    other, module = CALLS[name]
    description = f"calls {other}() for {name}()"
    if isinstance(node.func, cst.Attribute):
        yield Change(node, node.func.attr, cst.Name(other), description)
    elif module:
        yield Change(node, node.func, expression(f"{module}.{other}"), description, (module,))


def slow_callback(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Make a callback sleep or raise."""
    if not isinstance(node, cst.FunctionDef) or not isinstance(node.body, cst.IndentedBlock):
        return
    if node.name.value in _called_back(program):
        for line, description in (("time.sleep(1.0)", "sleeps for 1 s"), ("raise RuntimeError('broken')", "raises")):
            body = with_body(node.body, [cst.parse_statement(line), *node.body.body])
            imports = ("time",) if "time" in line else ()
            yield Change(node, node.body, body, f"{node.name.value}() {description}", imports)


def empty_result(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Return an empty response or result from a callback."""
    function = program.function(node)
    if not isinstance(node, cst.Return) or not isinstance(node.value, cst.Name) or function is None:
        return
    if function.name.value in _called_back(program):
        name = node.value.value
        yield Change(node, node.value, expression(f"type({name})()"), f"returns an empty {name}")


def declared_type(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Declare a parameter as an integer instead of a double, or without a value."""
    if not isinstance(node, cst.Call) or called(node) != "declare_parameter" or len(node.args) < 2:
        return
    value = node.args[1].value
    if isinstance(value, cst.Float):
        new = expression(str(int(value.evaluated_value)))
        yield Change(node, value, new, f"declares {value.value} as an integer")
    yield Change(node, value, expression("None"), f"declares no default for {program.text(node.args[0].value)}")


def timer_clock(node: cst.CSTNode, program: ParsedProgram) -> Iterator[Change]:
    """Let a timer use the computer's clock."""
    if not isinstance(node, cst.Call) or called(node) != "create_timer" or "clock=" in program.text(node):
        return
    new = with_argument(node, "clock=rclpy.clock.Clock(clock_type=rclpy.clock.ClockType.STEADY_TIME)")
    yield Change(node, node, new, "the timer goes by the computer's clock", ("rclpy.clock",))


def _called_back(program: ParsedProgram) -> set[str]:
    """Return the names of the functions that are passed as callbacks."""
    passed = [
        argument(node, position, keyword)
        for node in program.nodes()
        for position, keyword in CALLBACKS.get(called(node), ())
    ]
    return {program.text(arg.value).rpartition(".")[2] for arg in passed if arg}


OPERATORS = (outcome, choice, not_asked, blocking, slow_callback, empty_result, declared_type, timer_clock)
