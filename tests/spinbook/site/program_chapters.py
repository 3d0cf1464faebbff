"""Chapters of programs and commands, for pages in which they are run and shown."""

from __future__ import annotations

from small_course import TALKER

_TALKER = """
```python title="talker.py"
import rclpy
from rclpy.node import Node


def main():
    rclpy.init()
    node = Node('talker')
    node.get_logger().info('version {version}')
    try:
        rclpy.spin(node)
    except KeyboardInterrupt:
        pass


if __name__ == '__main__':
    main()
```
"""
TERMINALS = f"""\
# Terminals

{_TALKER.format(version="one")}

{_TALKER.format(version="two")}

```bash
ros2 run robot talker
```

```bash seconds=60
ros2 topic pub /count std_msgs/msg/Int32 "data: 5"
```

```bash seconds=60 until="data: 5"
ros2 topic echo /count
```

```python title="launch/talkers.launch.py"
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, LogInfo, RegisterEventHandler, TimerAction
from launch.event_handlers import OnProcessStart
from launch_ros.actions import Node


def generate_launch_description():
    a = Node(package='robot', executable='talker', name='a')
    return LaunchDescription([
        DeclareLaunchArgument('rate', choices=['slow', 'fast'], default_value='slow'),
        a,
        RegisterEventHandler(OnProcessStart(target_action=a, on_start=[LogInfo(msg='a has started')])),
        TimerAction(period=0.2, actions=[Node(package='robot', executable='talker', name='b')]),
    ])
```

```bash
colcon build
ros2 launch robot talkers.launch.py
```

```bash
ros2 launch robot talkers.launch.py rate:=sideways
```

{_TALKER.format(version="three").replace("talker.py", "better_talker.py")}
"""

#: Two nodes with the same main(), a command and a line of code that are longer than a window, and housekeeping.
LONGER = f"""\
# Longer

{TALKER.replace("talker.py", "speaker.py")}
```python title="listener.py"
class Listener(Node):
    TOPICS = [{", ".join(f"'/topic_{number}'" for number in range(20))}]


def main{TALKER.partition("def main")[2].replace("Talker", "Listener")}
```bash
ros2 topic pub --rate 2 /joint_commands sensor_msgs/msg/JointState "{{name: [left_elbow], position: [{"0.5, " * 30}]}}"
```

```python
%stop --all
```
"""

PIECES = """\
# Pieces

```text title="msg/Count.msg"
int64 number 7
```

```python
import rclpy
from rclpy.node import Node
from robot_interfaces.msg import Count
```

```python title="counter.py" seconds=20 until="counted 7"
class Counter(Node):
    def __init__(self):
        super().__init__("counter")
        self.create_subscription(Count, "count", self.heard, 10)
        self.publisher = self.create_publisher(Count, "count", 10)
        self.create_timer(0.1, lambda: self.publisher.publish(Count()))

    def heard(self, count):
        self.get_logger().info(f"counted {count.number}")
```

```bash
ros2 run arm counter_node
```

```python title="setup.py"
from setuptools import setup

setup(name="arm", entry_points={"console_scripts": ["counter_node = arm.counter:main"]})
```

```bash until="World: 2"
ros2 run demo_nodes_cpp talker
```

```bash seconds=20 until="heard"
ros2 run demo_nodes_py listener --ros-args -r __node:=ear
```
"""
