"""tf_transformations: against rotations put together by Rodrigues' formula."""

from __future__ import annotations

import itertools
from functools import reduce
from typing import Any

import numpy as np
import pytest
import tf_transformations as tf
from numpy.typing import NDArray

ORDERS = ["".join(axes) for axes in itertools.product("xyz", repeat=3) if axes[0] != axes[1] != axes[2]]


def turned(angle: float, name: str) -> NDArray[Any]:
    """Rodrigues' formula about one of the axes."""
    x, y, z = np.identity(3)["xyz".index(name)]
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.array(np.identity(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross)


@pytest.mark.parametrize("kind", ["s", "r"])
@pytest.mark.parametrize("middle", [0.7, -2.5, 0.0, np.pi / 2])
def test_euler_angles_in_every_order_and_back(kind: str, middle: float) -> None:
    for order in ORDERS:
        angles = (0.3, middle, -1.1)
        parts = [turned(angle, name) for angle, name in zip(angles, order, strict=True)]
        expected = reduce(np.dot, parts[::-1] if kind == "s" else parts)
        matrix = tf.euler_matrix(*angles, kind + order)
        assert np.allclose(matrix[:3, :3], expected)
        assert np.allclose(tf.euler_matrix(*tf.euler_from_matrix(matrix, kind + order), kind + order), matrix)
        assert np.allclose(tf.quaternion_matrix(tf.quaternion_from_matrix(matrix)), matrix)


def test_what_programs_write_most() -> None:
    quaternion = tf.quaternion_from_euler(0.0, 0.0, np.pi / 2)
    assert np.allclose(quaternion, [0, 0, np.sqrt(0.5), np.sqrt(0.5)])
    assert tf.euler_from_quaternion(quaternion) == pytest.approx((0.0, 0.0, np.pi / 2))
    assert np.allclose(tf.quaternion_multiply(quaternion, tf.quaternion_inverse(quaternion)), [0, 0, 0, 1])
    assert np.allclose(
        tf.quaternion_slerp([0, 0, 0, 1], quaternion, 0.5), tf.quaternion_about_axis(np.pi / 4, [0, 0, 1])
    )
    moved = tf.concatenate_matrices(tf.translation_matrix([1, 2, 3]), tf.quaternion_matrix(quaternion))
    assert np.allclose(moved @ [1, 0, 0, 1], [1, 3, 3, 1])
    assert tf.is_same_transform(tf.inverse_matrix(moved) @ moved, tf.identity_matrix())
    with pytest.raises(ValueError, match="'szzx'"):
        tf.quaternion_from_euler(0, 0, 0, "szzx")
