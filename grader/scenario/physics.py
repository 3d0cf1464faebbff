"""A world of rigid bodies, simulated by MuJoCo (https://mujoco.readthedocs.io): `pip install spinbook[physics]`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from grader.recording.events import Fields

FLOAT, FLOATS, JOINT_STATE = "std_msgs/msg/Float64", "std_msgs/msg/Float64MultiArray", "sensor_msgs/msg/JointState"

Names = str | Sequence[str]


class MuJoCo:
    """A model in MuJoCo's XML format (MJCF): actuators are commands, sensors are topics.

    Angles are in rad, lengths in m, forces in N, as in the model. The same commands give the same bits in every run.
    """

    def __init__(
        self,
        model: str,
        commands: dict[str, Names] | None = None,
        sensors: dict[str, Names] | None = None,
        joint_states: str = "",
        start: dict[str, float] | None = None,
    ) -> None:
        """Begin with the joints at `start`, and the others as in the model.

        `commands` has the actuators that each topic sets, `sensors` the sensors that each topic publishes: one name for
        a Float64, several for a Float64MultiArray. `joint_states` is a topic for all hinges and slides. `model` is the
        XML; in a `World` it is the name of a file next to scenarios.py.
        """
        try:
            import mujoco  # only here: few exercises need it
        except ImportError:
            raise ImportError("MuJoCo is not installed: pip install 'spinbook[physics]'") from None
        self._mujoco: Any = mujoco
        self._model = mujoco.MjModel.from_xml_string(model)
        self._data = mujoco.MjData(self._model)
        self._commands, self._sensors = commands or {}, sensors or {}
        self._joint_states = joint_states
        self.reads = {topic: _type(names) for topic, names in self._commands.items()}
        self.publishes = {topic: _type(names) for topic, names in self._sensors.items()}
        self.publishes |= {joint_states: JOINT_STATE} if joint_states else {}
        joints = map(self._model.joint, range(self._model.njnt))
        self._joints = [joint for joint in joints if joint.name and len(joint.qpos0) == 1]
        self._pushes: list[tuple[float, int, list[float]]] = []
        for name, position in (start or {}).items():
            self._data.joint(name).qpos[0] = position
        mujoco.mj_forward(self._model, self._data)
        for known, every in ((self._model.actuator, self._commands), (self._model.sensor, self._sensors)):
            for name in (name for names in every.values() for name in _list(names)):
                known(name)  # which raises KeyError with the names of the model

    @staticmethod
    def with_files(arguments: dict[str, Any], folder: Path) -> dict[str, Any]:
        """Return the arguments with the model's text for its file. Raises OSError."""
        return {**arguments, "model": (folder / arguments["model"]).read_text(encoding="utf-8")}

    def hear(self, topic: str, message: Any) -> None:
        """Take a command. Numbers that are not finite are ignored."""
        names = self._commands[topic]
        values = [message.data] if isinstance(names, str) else message.data
        for name, value in zip(_list(names), values, strict=False):
            if abs(value) < float("inf"):
                self._data.actuator(name).ctrl[0] = value

    def push(self, body: str, force: Sequence[float], seconds: float = 0.1) -> None:
        """Push a body with this force (N; x, y, z of the world) for this many seconds: a step of a scenario."""
        self._pushes.append((self._data.time + seconds, self._model.body(body).id, [float(one) for one in force]))

    def step(self, seconds: float) -> None:
        """Move on, in steps of the model's timestep."""
        end = self._data.time + seconds - self._model.opt.timestep / 2
        while self._data.time < end:
            self._data.xfrc_applied[:] = 0
            for until, body, force in self._pushes:
                if self._data.time < until:
                    self._data.xfrc_applied[body, :3] += force
            self._pushes = [push for push in self._pushes if self._data.time < push[0]]
            left = round((end - self._data.time) / self._model.opt.timestep + 0.5)
            self._mujoco.mj_step(self._model, self._data, 1 if self._pushes else max(left, 1))
        self._mujoco.mj_forward(self._model, self._data)  # after a step, sensors show the moment before it

    def state(self) -> dict[str, Fields]:
        """Return what the sensors show."""
        state = {topic: {"data": self._reading(names)} for topic, names in self._sensors.items()}
        if self._joint_states:
            state[self._joint_states] = {
                "name": [joint.name for joint in self._joints],
                "position": self._positions(),
                "velocity": [float(self._data.joint(joint.id).qvel[0]) for joint in self._joints],
            }
        return state

    def _reading(self, names: Names) -> float | list[float]:
        values = [float(value) for name in _list(names) for value in self._data.sensor(name).data]
        return values[0] if isinstance(names, str) else values

    def _positions(self) -> list[float]:
        return [float(self._data.joint(joint.id).qpos[0]) for joint in self._joints]

    def truth(self) -> Fields:
        """Return the position of each joint, and of each body as a list of x, y, z, by their names."""
        bodies = [self._model.body(number) for number in range(1, self._model.nbody)]
        joints = dict(zip((joint.name for joint in self._joints), self._positions(), strict=True))
        return {**joints, **{body.name: self._data.xpos[body.id].tolist() for body in bodies}}


def _list(names: Names) -> list[str]:
    return [names] if isinstance(names, str) else list(names)


def _type(names: Names) -> str:
    return FLOAT if isinstance(names, str) else FLOATS
