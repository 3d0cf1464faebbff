"""Point clouds as numpy arrays, and back. Names and arguments are those of ROS 2's sensor_msgs_py."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.lib.recfunctions import structured_to_unstructured, unstructured_to_structured
from numpy.typing import NDArray
from sensor_msgs.msg import PointCloud2, PointField
from std_msgs.msg import Header

#: The numpy type of each type that a field may have: https://docs.ros.org/en/jazzy/p/sensor_msgs/interfaces/msg/PointField.html
_DATATYPES: dict[int, Any] = {
    PointField.INT8: np.dtype(np.int8),
    PointField.UINT8: np.dtype(np.uint8),
    PointField.INT16: np.dtype(np.int16),
    PointField.UINT16: np.dtype(np.uint16),
    PointField.INT32: np.dtype(np.int32),
    PointField.UINT32: np.dtype(np.uint32),
    PointField.FLOAT32: np.dtype(np.float32),
    PointField.FLOAT64: np.dtype(np.float64),
}

#: What a field without a name is called.
DUMMY_FIELD_PREFIX = "unnamed_field"


def read_points(
    cloud: PointCloud2,
    field_names: Sequence[str] | None = None,
    skip_nans: bool = False,
    uvs: Iterable[Any] | None = None,
    reshape_organized_cloud: bool = False,
) -> NDArray[Any]:
    """Return a cloud's points as a structured array: one entry per point, with a field for each name.

    `uvs` chooses points by their indices, or by (column, row) in an organized cloud. `reshape_organized_cloud` keeps
    rows and columns. Raises ValueError for a field that the cloud does not have.
    """
    type_ = dtype_from_fields(cloud.fields, cloud.point_step)
    rows = np.frombuffer(cloud.data, np.uint8)[: cloud.height * cloud.row_step].reshape(cloud.height, -1)
    # A row may be longer than its points.
    packed = np.ascontiguousarray(rows[:, : cloud.width * cloud.point_step]).view(type_).reshape(-1)
    points: NDArray[Any] = packed.byteswap() if bool(cloud.is_bigendian) != (sys.byteorder == "big") else packed
    points = points[_names(points) if field_names is None else _known(points, field_names)]
    if skip_nans and not cloud.is_dense:
        points = points[_without_nan(points)]
    if uvs is not None:
        points = points[_indices(uvs, cloud.width)]
    if reshape_organized_cloud and cloud.height > 1:
        points = points.reshape(cloud.height, cloud.width)
    return points


def _names(points: NDArray[Any]) -> list[str]:
    return list(points.dtype.names or ())


def _known(points: NDArray[Any], names: Sequence[str]) -> list[str]:
    for name in names:
        if name not in _names(points):
            raise ValueError(f"The cloud has no field {name!r}. Its fields: {', '.join(_names(points))}")
    return list(names)


def _without_nan(points: NDArray[Any]) -> NDArray[np.bool_]:
    kept = np.ones(len(points), dtype=bool)
    for name in _names(points):
        nan = np.isnan(points[name])
        kept &= ~(nan if nan.ndim == 1 else nan.any(axis=-1))
    return kept


def _indices(uvs: Iterable[Any], width: int) -> NDArray[np.intp]:
    chosen = np.array(list(uvs), dtype=np.intp)
    return chosen[:, 1] * width + chosen[:, 0] if chosen.ndim == 2 else chosen


def read_points_numpy(
    cloud: PointCloud2,
    field_names: Sequence[str] | None = None,
    skip_nans: bool = False,
    uvs: Iterable[Any] | None = None,
    reshape_organized_cloud: bool = False,
) -> NDArray[Any]:
    """Return a cloud's points as a plain array, a column per field, which must all be of the same type."""
    points = read_points(cloud, field_names, skip_nans, uvs, reshape_organized_cloud)
    types = {points.dtype[name].base for name in _names(points)}
    if len(types) > 1:
        names = ", ".join(f"{name} ({points.dtype[name]})" for name in _names(points))
        raise ValueError(
            f"The fields are of different types: {names}. Choose some with field_names, or use read_points"
        )
    return structured_to_unstructured(points)


def read_points_list(
    cloud: PointCloud2,
    field_names: Sequence[str] | None = None,
    skip_nans: bool = False,
    uvs: Iterable[Any] | None = None,
) -> list[Any]:
    """Return a cloud's points as a list of tuples."""
    return list(read_points(cloud, field_names, skip_nans, uvs).tolist())


def dtype_from_fields(fields: Iterable[PointField], point_step: int | None = None) -> np.dtype[Any]:
    """Return the numpy type of one point: each field at its offset (bytes)."""
    names, formats, offsets = [], [], []
    for number, one in enumerate(fields):
        kind = _DATATYPES[one.datatype]
        names.append(one.name or f"{DUMMY_FIELD_PREFIX}_{number}")
        formats.append(kind if one.count == 1 else (kind, (one.count,)))
        offsets.append(one.offset)
    layout: Any = {"names": names, "formats": formats, "offsets": offsets}
    if point_step is not None:
        layout["itemsize"] = point_step
    made: np.dtype[Any] = np.dtype(layout)
    return made


def create_cloud(
    header: Header, fields: Sequence[PointField], points: Any, step: int | None = None, point_step: int | None = None
) -> PointCloud2:
    """Return a cloud with these fields and points: a structured array, a plain one, or a sequence of tuples.

    An array with two dimensions of points is an organized cloud. A point takes `point_step` bytes, by default as
    many as its fields.
    """
    type_ = dtype_from_fields(fields, point_step if point_step is not None else step)
    given = points if isinstance(points, np.ndarray) else np.array(list(map(tuple, points)), dtype=type_)
    array = given if given.dtype.names else unstructured_to_structured(given, dtype=type_)
    array = array.astype(type_, copy=False)
    height, width = array.shape if array.ndim == 2 else (1, len(array))
    cloud = PointCloud2(header=header, height=height, width=width, fields=list(fields))
    cloud.is_bigendian, cloud.is_dense = sys.byteorder != "little", False
    cloud.point_step, cloud.row_step = type_.itemsize, type_.itemsize * width
    cloud.data = np.ascontiguousarray(array).tobytes()
    return cloud


def create_cloud_xyz32(header: Header, points: Any) -> PointCloud2:
    """Return a cloud of points with x, y and z as 32-bit numbers (m)."""
    fields = [
        PointField(name=name, offset=4 * index, datatype=PointField.FLOAT32, count=1)
        for index, name in enumerate(("x", "y", "z"))
    ]
    return create_cloud(header, fields, points)
