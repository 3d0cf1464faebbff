"""Paints a robot without a browser, for print, for notebooks' front ends without scripts, and until a page has loaded.

The same shapes, light and view as in robot_view.js, which paints on the graphics card: a change here is a change there.
Rays are followed through each shape's distance field: J. C. Hart, "Sphere Tracing", The Visual Computer 12, 1996.
"""

from __future__ import annotations

import itertools
import math
import struct
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from tf2_py.rigid_motion import RigidMotion

from ros_in_python.robot.drawing import outside, shapes_of
from ros_in_python.robot.kinematics import link_motions
from ros_in_python.robot.urdf import LinkShape, RobotDescription

Array = Any

#: Width and height of a picture (CSS pixels); a PNG has `SCALE` times as many pixels.
WIDTH, HEIGHT, SCALE = 420, 460, 2
_AZIMUTH, _ELEVATION, _FOCAL = 0.5, 0.16, 3.6
_RED = np.array([0.85, 0.16, 0.12])
_LIGHT = (0.35, 0.5, 0.8)
_STEPS = 48


@dataclass(frozen=True)
class _PlacedShape:
    """A shape in the world: `turn` is its rotation (3 x 3), `place` its middle (m), `colour` from 0 to 1."""

    kind: str
    half: Array
    turn: Array
    place: Array
    colour: Array

    @property
    def edge(self) -> float:
        return float(min(self.half)) * {"box": 0.62, "sphere": 1.0}.get(self.kind, 0.45)

    def nearest(self, points: Array) -> Array:
        """Return the nearest points of the shape without its rounded edges; in the shape's own frame."""
        inner = self.half - self.edge
        if self.kind == "cylinder":
            away = np.hypot(points[:, 0], points[:, 1])
            part = np.minimum(1.0, inner[0] / np.maximum(away, 1e-9))
            return np.column_stack([points[:, 0] * part, points[:, 1] * part, points[:, 2].clip(-inner[2], inner[2])])
        return points.clip(-inner, inner)

    def balls(self) -> list[tuple[float, ...]]:
        """Return up to three balls (x, y, z, radius) that stand for the shape when it throws a shadow."""
        axis, radius = int(np.argmax(self.half)), float(np.sort(self.half)[1])
        count = min(3, max(1, round(float(self.half[axis]) / radius)))
        along = np.linspace(-1, 1, count) * (self.half[axis] - radius) if count > 1 else [0.0]
        return [(*(self.place + self.turn[:, axis] * part), radius) for part in along]


@dataclass(frozen=True)
class _Scene:
    """What is seen, and from where: `view` has the directions right, up and towards the viewer as columns."""

    shapes: list[_PlacedShape]
    middle: Array
    radius: float
    ground: float
    eye: Array
    view: Array
    light: Array

    @property
    def balls(self) -> list[tuple[float, ...]]:
        return [ball for shape in self.shapes for ball in shape.balls()]


def as_png(robot: RobotDescription, positions: Mapping[str, float], scale: float = SCALE) -> bytes:
    """Return the picture of a robot whose joints have these positions (rad or m), on nothing."""
    width, height = round(WIDTH * scale), round(HEIGHT * scale)
    pixels = np.round(255 * _painted(_scene(robot, positions), width, height).clip(0, 1)).astype(np.uint8)
    return _png(pixels.reshape(height, width, 4))


def _png(pixels: Array) -> bytes:
    """Return these pixels (rows, columns, RGBA) as a PNG (W3C, "Portable Network Graphics", third edition, 2025).

    Each row is stored as its difference from the row above, filter type 2, which makes it half as large.
    """
    height, width, _ = pixels.shape
    above = np.concatenate([np.zeros_like(pixels[:1]), pixels[:-1]])
    rows = np.column_stack([np.full(height, 2, np.uint8), (pixels - above).reshape(height, -1)])
    header = struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)
    chunks = ((b"IHDR", header), (b"IDAT", zlib.compress(rows.tobytes())), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data)) for kind, data in chunks
    )


def _scene(robot: RobotDescription, positions: Mapping[str, float]) -> _Scene:
    rest = [_placed(shape, at, 0.0) for shape, at in _where(robot, {})]
    signs = np.array(list(itertools.product((-1, 1), repeat=3)))
    corners = np.concatenate([(signs * shape.half) @ shape.turn.T + shape.place for shape in rest])
    low, high = corners.min(0), corners.max(0)
    middle, radius = (low + high) / 2, float(np.linalg.norm(high - low)) / 2 or 1.0
    ca, sa, ce, se = (f(x) for x in (_AZIMUTH, _ELEVATION) for f in (math.cos, math.sin))
    back = np.array([ca * ce, sa * ce, se])
    view = np.column_stack([(-sa, ca, 0.0), (-ca * se, -sa * se, ce), back])
    light = np.array([ca * _LIGHT[0] + sa * _LIGHT[1], sa * _LIGHT[0] - ca * _LIGHT[1], _LIGHT[2]])
    red = {joint.child for joint in outside(robot, positions)}
    shapes = [_placed(shape, at, _redness(shape, red)) for shape, at in _where(robot, positions)]
    eye = middle + back * radius * _FOCAL
    return _Scene(shapes, middle, radius, float(low[2]), eye, view, light / np.linalg.norm(light))


def _where(robot: RobotDescription, positions: Mapping[str, float]) -> list[tuple[LinkShape, RigidMotion]]:
    links = link_motions(robot, positions)
    return [(shape, shape.origin.then(links[shape.link])) for shape in shapes_of(robot)]


def _redness(shape: LinkShape, red: set[str]) -> float:
    """Return how red a shape is: the joint itself is, and the rest of its link a little."""
    return 0.0 if shape.link not in red else 0.55 if any(shape.origin.translation) else 1.0


def _placed(shape: LinkShape, at: RigidMotion, redness: float) -> _PlacedShape:
    turn = np.column_stack([np.subtract(at.moved(axis), at.translation) for axis in ((1, 0, 0), (0, 1, 0), (0, 0, 1))])
    colour = np.array(shape.colour or (0.93, 0.92, 0.89))
    return _PlacedShape(
        shape.kind, np.array(shape.half), turn, np.array(at.translation), colour + redness * (_RED - colour)
    )


def _painted(scene: _Scene, width: int, height: int) -> Array:
    """Return red, green, blue and opacity of each pixel."""
    x, y = np.meshgrid((np.arange(width) + 0.5) * 2 - width, height - (np.arange(height) + 0.5) * 2)
    rays = np.column_stack([x.ravel(), y.ravel(), np.full(x.size, -_FOCAL * height)]) @ scene.view.T
    rays /= _length(rays)[:, None]
    picture, depth = _ground(scene, rays)
    for shape in scene.shapes:
        seen, far, normals = _hits(shape, scene.eye, rays)
        front = far < depth[seen]
        seen, far, normals = seen[front], far[front], normals[front]
        depth[seen] = far
        colours = _lit(scene, shape.colour, scene.eye + rays[seen] * far[:, None], normals, -rays[seen])
        picture[seen] = np.column_stack([colours, np.ones(len(seen))])
    return picture


def _hits(shape: _PlacedShape, eye: Array, rays: Array) -> tuple[Array, Array, Array]:
    """Return the rays that meet a shape, by number; how far away (m); and in which direction its surface looks."""
    start, own = (eye - shape.place) @ shape.turn, np.flatnonzero(_near(shape, eye, rays))
    turned, size = rays[own] @ shape.turn, float(np.linalg.norm(shape.half))
    far = np.full(len(own), float(np.linalg.norm(start)) - size)
    last = float(np.linalg.norm(start)) + size
    hit, going = np.zeros(len(own), bool), np.arange(len(own))
    for _ in range(_STEPS):
        points = start + turned[going] * far[going, None]
        distance = _length(points - shape.nearest(points)) - shape.edge
        far[going] += distance
        arrived = distance < 0.004 * size
        hit[going[arrived]] = True
        going = going[~arrived & (far[going] < last)]
    points = (start + turned * far[:, None])[hit]
    return own[hit], far[hit], ((points - shape.nearest(points)) / shape.edge) @ shape.turn.T


def _dot(first: Array, second: Array) -> Array:
    """Return the scalar product of each row of `first` and of `second`."""
    return np.einsum("ij,ij->i", first, second)


def _length(rows: Array) -> Array:
    return np.sqrt(_dot(rows, rows))


def _near(shape: _PlacedShape, eye: Array, rays: Array) -> Array:
    """Return which rays meet the ball around a shape."""
    to = shape.place - eye
    return to @ to - (rays @ to) ** 2 <= shape.half @ shape.half


def _lit(scene: _Scene, colour: Array, points: Array, normals: Array, to: Array) -> Array:
    """Return the colours of these points: sky, light, shine, a bright rim, and less where other shapes are near."""
    free = np.ones(len(points))
    for *place, radius in scene.balls:
        away = np.array(place) - points
        far = _length(away)
        size = radius / far
        dark = 0.75 * np.maximum(_dot(normals, away) / far, 0) * size**2
        free *= np.where(size < 0.9, 1 - dark, 1)
    rise = (((points[:, 2] - scene.ground) / scene.radius + normals[:, 2] + 0.2) / 1.2).clip(0, 1)
    free *= 0.75 + 0.25 * rise**2 * (3 - 2 * rise)
    lit = np.maximum(normals @ scene.light * 0.72 + 0.28, 0)[:, None]
    middle = scene.light + to
    shine = np.maximum(_dot(normals, middle) / _length(middle), 0) ** 40 * 0.22
    rim = (1 - np.maximum(_dot(normals, to), 0)) ** 3 * 0.1
    up = normals[:, 2:] * 0.5 + 0.5
    sky = np.array([0.42, 0.44, 0.47]) * (1 - up) + np.array([0.62, 0.66, 0.7]) * up
    return colour * (sky + lit * np.array([0.58, 0.55, 0.5])) * free[:, None] + (shine + rim)[:, None]


def _ground(scene: _Scene, rays: Array) -> tuple[Array, Array]:
    """Return the picture of the ground with the shadow on it, and how far away it is (m)."""
    picture, depth = np.zeros((len(rays), 4)), np.full(len(rays), np.inf)
    below = np.flatnonzero(rays[:, 2] < 0)
    depth[below] = (scene.ground - scene.eye[2]) / rays[below, 2]
    points = (scene.eye + rays[below] * depth[below][:, None])[:, :2]
    fade = ((_length(points - scene.middle[:2]) / scene.radius - 0.2) / 0.52).clip(0, 1)
    near = fade < 1
    points, edge = points[near], 1 - (fade**2 * (3 - 2 * fade))[near]
    lit = np.ones(len(points))
    for x, y, z, radius in scene.balls:
        height = max(z - scene.ground, 0.0)
        wide = radius * 0.75 + height * 0.22
        away = points - (x, y) + scene.light[:2] / scene.light[2] * height
        lit *= 1 - 0.6 * (radius / wide) ** 2 * np.exp(-_dot(away, away) / (2 * wide**2))
    dark = (1 - lit) * edge * 0.62
    opacity = 0.16 * edge + dark * (1 - 0.16 * edge)
    grey = 0.16 * edge * (1 - dark) / np.maximum(opacity, 1e-6)
    picture[below[near]] = np.column_stack([0.5 * grey, 0.56 * grey, 0.56 * grey, opacity])
    return picture, depth
