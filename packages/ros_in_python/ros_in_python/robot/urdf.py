"""Reads a robot's links, joints and limits from a URDF, and its boxes, cylinders and spheres. Inertia is left out.

The format: https://wiki.ros.org/urdf/XML (it is the same in ROS 2). PyPI's readers bring meshes and a renderer along,
or have not been kept since 2021; joints alone are a page.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from xml.etree import ElementTree

from tf2_py.rigid_motion import IDENTITY, RigidMotion, Vector, from_euler

MOVING = ("revolute", "continuous", "prismatic")
_KINDS = (*MOVING, "fixed", "floating", "planar")


class InvalidUrdf(Exception):
    """A text is no URDF, or one whose joints don't form a tree."""


@dataclass(frozen=True)
class Mimic:
    """A joint that follows another: its position is that joint's times `multiplier`, plus `offset` (rad or m)."""

    joint: str
    multiplier: float = 1.0
    offset: float = 0.0

    def follow(self, position: float) -> float:
        """Return the position (rad or m) that belongs to one of the joint that is followed."""
        return self.multiplier * position + self.offset


@dataclass(frozen=True)
class Joint:
    """A joint: `origin` is where it is in the parent link; it turns about or moves along `axis`."""

    name: str
    kind: str
    parent: str
    child: str
    origin: RigidMotion = IDENTITY
    axis: Vector = (1.0, 0.0, 0.0)
    lower: float = 0.0
    upper: float = 0.0
    mimic: Mimic | None = None

    @property
    def moves(self) -> bool:
        """Whether its position is one number."""
        return self.kind in MOVING

    @property
    def is_limited(self) -> bool:
        """Whether it has a lowest and a highest position."""
        return self.moves and self.kind != "continuous" and self.lower < self.upper

    @property
    def rest(self) -> float:
        """Its position before anything moved it: 0, or the middle of its limits if 0 is outside (rad or m)."""
        return (self.lower + self.upper) / 2 if self.is_limited and not self.lower <= 0.0 <= self.upper else 0.0


@dataclass(frozen=True)
class LinkShape:
    """What a link looks like, or a part of it: a "box", "cylinder" (along z), "sphere", or a "mesh", which has no size.

    `half` is half its size along x, y and z (m), `origin` where it is in the link, and `colour` red, green and blue
    (0 to 1), None if the URDF does not say.
    """

    link: str
    kind: str
    half: Vector
    origin: RigidMotion = IDENTITY
    colour: Vector | None = None


@dataclass(frozen=True)
class RobotDescription:
    """A robot's name, its links, its joints and its shapes, in the order of the file."""

    name: str
    links: tuple[str, ...]
    joints: tuple[Joint, ...]
    shapes: tuple[LinkShape, ...] = ()

    @property
    def root(self) -> str:
        """The link that is no joint's child."""
        children = {joint.child for joint in self.joints}
        return next(link for link in self.links if link not in children)


def read(text: str) -> RobotDescription:
    """Return the robot that a URDF describes. Raises `InvalidUrdf`, with what to change."""
    try:
        robot = ElementTree.fromstring(text.strip().encode())
    except ElementTree.ParseError as error:
        raise InvalidUrdf(f"The URDF is not XML: {error}") from None
    if robot.tag != "robot":
        raise InvalidUrdf(f"The URDF's outermost element is <{robot.tag}>, not <robot>")
    if any("xacro" in element.tag for element in robot.iter()):
        raise InvalidUrdf("This is xacro, not yet URDF: expand it first, with the xacro command (pip install xacro)")
    links = tuple(_attribute(link, "name") for link in robot.findall("link"))
    joints = tuple(_joint(element) for element in robot.findall("joint"))
    _check(links, joints)
    colours = {m.get("name", ""): m for m in robot.iter("material") if m.find("color") is not None}
    shapes = tuple(
        shape
        for link in robot.findall("link")
        for visual in link.findall("visual")
        for shape in _shapes(_attribute(link, "name"), visual, colours)
    )
    return RobotDescription(robot.get("name", ""), links, joints, shapes)


def _shapes(link: str, visual: ElementTree.Element, colours: Mapping[str, ElementTree.Element]) -> Iterator[LinkShape]:
    origin, material = _origin(visual.find("origin")), visual.find("material")
    if material is not None and material.find("color") is None:
        material = colours.get(material.get("name", ""))
    colour = None if material is None else _colour(material.find("color"))
    for element in visual.findall("geometry/*"):
        if (half := _half(element)) is not None:
            yield LinkShape(link, element.tag, half, origin, colour)


def _half(element: ElementTree.Element) -> Vector | None:
    radius = _number(element, "radius", 0.0)
    if element.tag == "box":
        x, y, z = _vector(element, "size", (0.0, 0.0, 0.0))
        return (x / 2, y / 2, z / 2)
    if element.tag == "cylinder":
        return (radius, radius, _number(element, "length", 0.0) / 2)
    return {"sphere": (radius, radius, radius), "mesh": (0.0, 0.0, 0.0)}.get(element.tag)


def _colour(color: ElementTree.Element | None) -> Vector | None:
    text = "" if color is None else color.get("rgba", "")
    try:
        red, green, blue, _ = (float(word) for word in text.split())
    except ValueError:
        raise InvalidUrdf(f'rgba="{text}" is not four numbers') from None
    return (red, green, blue)


def _joint(element: ElementTree.Element) -> Joint:
    name, kind = _attribute(element, "name"), _attribute(element, "type")
    if kind not in _KINDS:
        raise InvalidUrdf(f"The joint {name} has the type {kind!r}; there are {', '.join(_KINDS)}")
    limit, axis, mimic = element.find("limit"), element.find("axis"), element.find("mimic")
    return Joint(
        name,
        kind,
        _link_of(element, "parent", name),
        _link_of(element, "child", name),
        _origin(element.find("origin")),
        _vector(axis, "xyz", (1.0, 0.0, 0.0)),
        _number(limit, "lower", 0.0),
        _number(limit, "upper", 0.0),
        None if mimic is None else _mimic(mimic),
    )


def _mimic(element: ElementTree.Element) -> Mimic:
    joint = _attribute(element, "joint")
    return Mimic(joint, _number(element, "multiplier", 1.0), _number(element, "offset", 0.0))


def _attribute(element: ElementTree.Element, name: str) -> str:
    value = element.get(name)
    if value is None:
        raise InvalidUrdf(f"A <{element.tag}> has no attribute {name!r}")
    return value


def _link_of(joint: ElementTree.Element, end: str, name: str) -> str:
    element = joint.find(end)
    if element is None:
        raise InvalidUrdf(f"The joint {name} has no <{end}>")
    return _attribute(element, "link")


def _origin(element: ElementTree.Element | None) -> RigidMotion:
    turn = _vector(element, "rpy", (0.0, 0.0, 0.0))
    return RigidMotion(_vector(element, "xyz", (0.0, 0.0, 0.0)), from_euler(*turn))


def _vector(element: ElementTree.Element | None, name: str, default: Vector) -> Vector:
    text = None if element is None else element.get(name)
    if text is None:
        return default
    try:
        x, y, z = (float(word) for word in text.split())
    except ValueError:
        raise InvalidUrdf(f'{name}="{text}" is not three numbers') from None
    return (x, y, z)


def _number(element: ElementTree.Element | None, name: str, default: float) -> float:
    text = None if element is None else element.get(name)
    try:
        return default if text is None else float(text)
    except ValueError:
        raise InvalidUrdf(f'{name}="{text}" is not a number') from None


def _check(links: tuple[str, ...], joints: tuple[Joint, ...]) -> None:
    if not links:
        raise InvalidUrdf("The URDF has no <link>")
    names = {joint.name for joint in joints}
    for joint in joints:
        for link in (joint.parent, joint.child):
            if link not in links:
                raise InvalidUrdf(f"The joint {joint.name} names the link {link!r}, which does not exist")
        if joint.mimic and joint.mimic.joint not in names:
            raise InvalidUrdf(f"The joint {joint.name} mimics {joint.mimic.joint!r}, which does not exist")
    children = [joint.child for joint in joints]
    roots = [link for link in links if link not in children]
    if len(roots) != 1 or len(set(children)) != len(children):
        raise InvalidUrdf(f"The links are not one tree: {len(roots)} of them are no joint's child ({', '.join(roots)})")
