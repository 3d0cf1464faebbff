"""The names of ROS 2's launch API that launch files may use here."""

from __future__ import annotations

import re

_SOURCES = (
    "AnyLaunchDescriptionSource",
    "FrontendLaunchDescriptionSource",
    "PythonLaunchDescriptionSource",
    "XMLLaunchDescriptionSource",
    "YAMLLaunchDescriptionSource",
)
#: What is read, and never started.
COMPOSABLE = ("ComposableNode", "ComposableNodeContainer", "LoadComposableNodes")
#: Module -> its names.
NAMES: dict[str, tuple[str, ...]] = {
    "launch": (
        *("Action", "Condition", "Event", "EventHandler", "LaunchContext", "LaunchDescription"),
        *(
            "LaunchDescriptionEntity",
            "LaunchDescriptionSource",
            "LaunchIntrospector",
            "LaunchService",
            "SomeSubstitutionsType",
            "Substitution",
        ),
    ),
    "launch.actions": (
        *("AppendEnvironmentVariable", "DeclareLaunchArgument", "ExecuteProcess", "GroupAction"),
        *("IncludeLaunchDescription", "LogInfo", "OpaqueFunction", "SetEnvironmentVariable"),
        *("SetLaunchConfiguration", "Shutdown", "TimerAction", "UnsetEnvironmentVariable", "EmitEvent"),
        *("RegisterEventHandler", "ExecuteLocal", "PopEnvironment", "PopLaunchConfigurations", "PushEnvironment"),
        *("PushLaunchConfigurations", "ResetEnvironment", "ResetLaunchConfigurations", "UnregisterEventHandler"),
        "UnsetLaunchConfiguration",
    ),
    "launch.conditions": (
        "IfCondition",
        "UnlessCondition",
        "LaunchConfigurationEquals",
        "LaunchConfigurationNotEquals",
    ),
    "launch.event_handlers": ("OnExecutionComplete", "OnProcessExit", "OnProcessIO", "OnProcessStart", "OnShutdown"),
    "launch.events": ("ExecutionComplete", "Shutdown", "matches_action"),
    "launch.events.process": (
        *("ProcessExited", "ProcessIO", "ProcessStarted", "ShutdownProcess", "SignalProcess", "matches_executable"),
        *("matches_name", "matches_pid"),
    ),
    "launch.launch_description_sources": _SOURCES,
    "launch.logging": ("get_logger",),
    "launch.substitutions": (
        *("EnvironmentVariable", "FindExecutable", "LaunchConfiguration", "PathJoinSubstitution", "PythonExpression"),
        *("TextSubstitution", "ThisLaunchFile", "ThisLaunchFileDir", "AllSubstitution", "AndSubstitution"),
        *("AnySubstitution", "EqualsSubstitution", "IfElseSubstitution", "NotEqualsSubstitution", "NotSubstitution"),
        *("OrSubstitution", "Command", "PathSubstitution", "AnonName", "FileContent", "LocalSubstitution"),
        "SubstitutionFailure",
    ),
    "launch.frontend": ("Entity", "Parser", "expose_action", "expose_substitution"),
    "launch.utilities": ("normalize_to_list_of_substitutions", "perform_substitutions"),
    "launch_ros": (),
    "launch_ros.actions": (
        *("LifecycleNode", "Node", "PushRosNamespace", "SetParametersFromFile", "SetRemap", "SetUseSimTime"),
        *("PushROSNamespace", "SetParameter", "RosTimer", "ROSTimer", "LifecycleTransition", "SetROSLogDir"),
        *COMPOSABLE[1:],
    ),
    "launch_ros.descriptions": (COMPOSABLE[0], "Parameter", "ParameterFile", "ParameterValue"),
    "launch_ros.event_handlers": ("OnStateTransition",),
    "launch_ros.events": ("matches_node_name",),
    "launch_ros.events.lifecycle": ("ChangeState", "StateTransition", "matches_node_name"),
    "launch_ros.parameter_descriptions": ("ParameterFile", "ParameterValue", "Parameter"),
    "launch_ros.substitutions": (
        "ExecutableInPackage",
        "FindPackage",
        "FindPackagePrefix",
        "FindPackageShare",
        "Parameter",
    ),
    "launch_xml": (),
    "launch_xml.launch_description_sources": _SOURCES,
    "launch_yaml": (),
    "launch_yaml.launch_description_sources": _SOURCES,
}
_INNER_CAPITAL = re.compile(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")


def _file_of(name: str) -> str:
    return _INNER_CAPITAL.sub("_", name).lower()


#: The same with ROS 2's modules of one name each, as in `from launch.actions.timer_action import TimerAction`.
ALL_NAMES: dict[str, tuple[str, ...]] = {
    f"{module}.{_file_of(name)}": (name,) for module, names in NAMES.items() for name in names if name[0].isupper()
}
ALL_NAMES |= NAMES
