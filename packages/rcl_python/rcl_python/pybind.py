"""The names under which rclpy finds all this: what `rclpy._rclpy_pybind11` offers."""

from __future__ import annotations

import types
from functools import partial
from typing import Any

from rcl_python import (
    action,
    arguments,
    cdr,
    clock,
    context,
    endpoints,
    handle,
    lifecycle,
    logs,
    names,
    node,
    qos,
    type_description,
    values,
    wait_set,
)
from rcl_python.graph import CLIENT, PUBLISHER, SERVICE, SUBSCRIPTION

RMW_IDENTIFIER = "rmw_python"

_CLASSES: dict[Any, tuple[str, ...]] = {
    action: ("ActionClient", "ActionGoalHandle", "ActionServer"),
    clock: ("Clock", "ClockEvent", "Timer"),
    context: (
        "Context", "GuardCondition", "install_signal_handlers", "uninstall_signal_handlers",
        "get_current_signal_handlers_options", "register_sigint_guard_condition", "unregister_sigint_guard_condition",
    ),
    endpoints: ("Client", "EventHandle", "Publisher", "Service", "Subscription"),
    handle: ("Destroyable",),
    lifecycle: ("LifecycleStateMachine",),
    node: ("Node",),
    qos: ("QoSCheckCompatibleResult", "rmw_qos_profile_t"),
    type_description: ("TypeDescriptionService",),
    wait_set: ("WaitSet",),
    values: (
        "ClockChange", "ClockType", "GoalEvent", "InvalidHandle", "NodeNameNonExistentError", "NotImplementedError",
        "QoSCompatibility", "RCLError", "RCLInvalidROSArgsError", "RCL_DEFAULT_DOMAIN_ID", "RCUTILS_LOG_SEVERITY",
        "RCUtilsError", "RMWError", "RMW_DURATION_INFINITE", "RMW_QOS_DEADLINE_BEST_AVAILABLE",
        "RMW_QOS_LIVELINESS_LEASE_DURATION_BEST_AVAILABLE", "SignalHandlerOptions", "TransitionCallbackReturnType",
        "UnknownROSArgsError", "UnsupportedEventTypeError", "rcl_duration_t", "rcl_publisher_event_type_t",
        "rcl_subscription_event_type_t", "rcl_time_point_t", "rmw_incompatible_type_status_t",
        "rmw_liveliness_changed_status_t", "rmw_liveliness_lost_status_t", "rmw_matched_status_t",
        "rmw_message_lost_status_t", "rmw_offered_deadline_missed_status_t", "rmw_qos_policy_kind_t",
        "rmw_request_id_t", "rmw_requested_deadline_missed_status_t", "rmw_requested_qos_incompatible_event_status_t",
        "rmw_service_info_t",
    ),
}  # fmt: skip

_FUNCTIONS: dict[str, Any] = {
    "action_get_rmw_qos_profile": qos.action_profile,
    "assert_liveliness": lambda publisher: None,
    "deserialize": endpoints.read,
    "expand_topic_name": names.expand,
    "get_client_names_and_types_by_node": partial(node.services_of, CLIENT, "client"),
    "get_publisher_names_and_types_by_node": partial(node.topics_of, PUBLISHER, "publisher"),
    "get_publishers_info_by_topic": partial(node.infos_by_topic, PUBLISHER),
    "get_rmw_implementation_identifier": lambda: RMW_IDENTIFIER,
    "get_service_names_and_types": node.service_names_and_types,
    "get_service_names_and_types_by_node": partial(node.services_of, SERVICE, "service"),
    "get_subscriber_names_and_types_by_node": partial(node.topics_of, SUBSCRIPTION, "subscriber"),
    "get_subscriptions_info_by_topic": partial(node.infos_by_topic, SUBSCRIPTION),
    "get_topic_names_and_types": node.topic_names_and_types,
    "get_validation_error_for_full_topic_name": names.full_topic_fault,
    "get_validation_error_for_namespace": names.namespace_fault,
    "get_validation_error_for_node_name": names.node_name_fault,
    "get_validation_error_for_topic_name": names.topic_fault,
    "logging_configure": context.configure_logging,
    "logging_fini": lambda: None,
    "logging_get_logger_effective_level": logs.effective_level,
    "logging_get_logger_level": logs.get_level,
    "logging_get_logging_directory": logs.directory,
    "logging_get_separator_string": lambda: ".",
    "logging_initialize": lambda: None,
    "logging_logger_is_enabled_for": logs.is_enabled_for,
    "logging_rcutils_log": logs.log,
    "logging_rosout_add_sublogger": logs.add_sublogger,
    "logging_rosout_remove_sublogger": logs.remove_sublogger,
    "logging_set_logger_level": logs.set_level,
    "logging_severity_level_from_string": logs.severity_from,
    "logging_shutdown": logs.shutdown,
    "qos_check_compatible": qos.check_compatible,
    "remap_topic_name": node.remap_topic_name,
    "remove_ros_args": arguments.without_ros_args,
    "resolve_name": node.resolve_name,
    "serialize": lambda message, message_class: cdr.serialize(message),
}


def module(name: str) -> types.ModuleType:
    """Return the module, ready for sys.modules."""
    made = types.ModuleType(name, "ROS 2 Python client library.")
    for source, offered in _CLASSES.items():
        for item in offered:
            thing = getattr(source, item)
            if isinstance(thing, type) and issubclass(thing, BaseException):
                thing.__module__ = name  # tracebacks show it
            setattr(made, item, thing)
    for item, function in _FUNCTIONS.items():
        setattr(made, f"rclpy_{item}", function)
    introspection = types.ModuleType(f"{name}.service_introspection")
    introspection.ServiceIntrospectionState = values.ServiceIntrospectionState  # type: ignore[attr-defined]
    made.service_introspection = introspection  # type: ignore[attr-defined]
    made.__getattr__ = _late  # type: ignore[method-assign]
    return made


def _late(name: str) -> Any:
    """Return what needs rclpy's own files: events arrive here one after another, so one executor serves for both."""
    if name == "EventsExecutor":
        from rclpy.executors import SingleThreadedExecutor

        return SingleThreadedExecutor
    raise AttributeError(f"module 'rclpy._rclpy_pybind11' has no attribute '{name}'")
